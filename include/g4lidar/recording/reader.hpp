// SPDX-License-Identifier: MIT
// Reads recordings from front to back, intact, cut off or damaged; and plays them as a device.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/recording/player.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// Whether the file at `path` begins like an MCAP file. Also false if it cannot be read.
[[nodiscard]] G4LIDAR_API bool is_recording(std::string_view path) noexcept;

/// One recorded item. A view, valid until the next call of any function of its reader.
struct recorded_item {
  /// The kind of item.
  enum class kind : std::uint8_t {
    from_device,  ///< `data` was read in one call.
    to_device,    ///< `data` was sent.
    other,        ///< The event `other`.
    odometry,     ///< The `odometry` of the robot; its time may be before that of the item before.
  };
  kind what;
  /// By the clock of the transport, when `data` had arrived or was sent; of `odometry`, computed from
  /// its stamp with the difference of the clocks at this place of the recording.
  std::int64_t time_ns;
  std::int64_t wall_ns;  ///< The same by the wall clock, nanoseconds since 1970.
  bytes data;
  recorded_event other;
  stamped_odometry odometry{};  ///< Its time is `time_ns`.
};

/// What is damaged in a file. All intact parts are read nevertheless.
struct recording_damage {
  std::uint64_t bytes_skipped = 0;  ///< Bytes of the file that belong to no intact part.
  std::uint64_t chunks_lost = 0;    ///< Chunks that were found with changed contents.
  bool is_cut_off = false;  ///< It has no proper end: the program was killed, or the disk was full.
  /// Whether there is any damage.
  [[nodiscard]] bool any() const noexcept {
    return bytes_skipped > 0 || chunks_lost > 0 || is_cut_off;
  }
};

/// How a recording is read.
struct reading_options {
  /// Only what was recorded from `from_ns` on and before `to_ns`, since the beginning of the
  /// recording.
  std::int64_t from_ns = 0;
  std::int64_t to_ns = std::numeric_limits<std::int64_t>::max();
  /// Called often while a function searches the file; true ends that function with cancelled. The
  /// next call continues there. It must not throw, and not use the reader.
  std::function<bool()> is_cancelled{};
};

/// Reads one file. *Single thread.* Memory is bounded for every file: one compressed chunk and one
/// uncompressed, of at most 64 MiB. The work for chunks without messages is bounded by the size of
/// the file, whatever they unpack to. With `from_ns` it begins at the right chunk, by the index if
/// the file has one.
class G4LIDAR_API recording_reader {
 public:
  /// Opens the file and finds the first recorded item. Fails with bad_file if it is not a recording
  /// of a lidar, has no intact part, or is of a model that is not known; with cancelled; with system.
  [[nodiscard]] static result<recording_reader> open(std::string_view path,
                                                     const reading_options& options = {});

  recording_reader(recording_reader&&) noexcept;
  recording_reader& operator=(recording_reader&&) noexcept;
  ~recording_reader();

  /// The next item; nothing at the end. Where bytes are missing it returns an event `gap`. Fails
  /// with system if the rest of the file cannot be read, and with cancelled.
  [[nodiscard]] result<std::optional<recorded_item>> next() noexcept;

  /// Calls `take` with each item until it returns false or the recording ends. Fails like next().
  template <class Take>
  [[nodiscard]] result<void> for_each(Take take) {
    while (true) {
      const auto found = next();
      if (!found) return tl::unexpected(found.error());
      const std::optional<recorded_item>& item = *found;
      if (!item || !take(*item)) return {};
    }
  }

  /// The model of the lidar. Valid forever. That of a moved-from reader is a G4.
  [[nodiscard]] const g4lidar::model& model() const noexcept;
  /// What is known about the lidar: from the metadata, or from its first replies; for a cut-off
  /// file, from what has been read so far.
  [[nodiscard]] const std::optional<recorded_device>& device() const noexcept;
  /// The digests of this file; only if it was closed.
  [[nodiscard]] const std::optional<recorded_digest>& digest() const noexcept;
  /// The time of the first item that is not odometry.
  [[nodiscard]] std::int64_t first_ns() const noexcept;
  /// The time of the last one; of a cut-off file, of the last one that can be read. At least first_ns().
  [[nodiscard]] std::int64_t last_ns() const noexcept;
  /// The damage found so far.
  [[nodiscard]] const recording_damage& damage() const noexcept;
  /// The position in the file, in bytes: for a progress bar.
  [[nodiscard]] std::uint64_t position() const noexcept;
  /// The size of the file, in bytes.
  [[nodiscard]] std::uint64_t size() const noexcept;

 private:
  friend struct recording_access;  // opens inputs that are not files
  class G4LIDAR_HIDDEN file_reader;
  explicit recording_reader(std::unique_ptr<file_reader> made) noexcept;
  std::unique_ptr<file_reader> made_;
};

/// Opens recordings as connectors, for lidar::open(). The device of the resulting transport does
/// not answer; the transport returns the bytes of each read as they were recorded, and ends with
/// end_of_input. Its clock is that of the recorded transport.
///
///     auto recording = g4lidar::replay::open("walk.mcap", {.speed = 1});
///     auto lidar = g4lidar::lidar::open(std::move(*recording));
class G4LIDAR_API replay {
 public:
  replay() = delete;

  /// `is_cancelled`: see reading_options; also while it is played. Fails with bad_option, or like
  /// recording_reader::open().
  [[nodiscard]] static result<std::unique_ptr<connector>> open(
      std::string_view path, const playback_options& options = {},
      const std::function<bool()>& is_cancelled = {});

  /// The reader of the recording that `from` plays, for its position and its damage; null if `from`
  /// is something else. Valid as long as `from`, or the lidar that owns it.
  [[nodiscard]] static const recording_reader* reader_of(connector& from) noexcept;
};

}  // namespace g4lidar
