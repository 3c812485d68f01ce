// SPDX-License-Identifier: MIT
// Reads recordings from the front to the back, whole, cut off or damaged.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

#include "g4lidar/bytes.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/line_note.hpp"
#include "g4lidar/recorded_device.hpp"
#include "g4lidar/recording_digest.hpp"

namespace g4lidar {

/// Whether the file at `path` begins as an MCAP file does. False, too, where it cannot be read.
[[nodiscard]] G4LIDAR_API bool is_recording(std::string_view path) noexcept;

/// One thing that was recorded. A view, good until the next call of anything of its reader.
struct recorded_item {
  /// What is recorded.
  enum class kind : std::uint8_t {
    from_device,  ///< `data` was read together.
    to_device,    ///< `data` was sent.
    note,         ///< `note` happened.
  };
  kind what;
  std::int64_t time_ns;  ///< By the clock of the line, when `data` had come.
  std::int64_t wall_ns;  ///< The same by the wall clock, since 1970.
  bytes data;
  line_note note;
};

/// What is wrong with a file. Nothing of it hides what is whole.
struct recording_damage {
  std::uint64_t bytes_skipped = 0;  ///< Of the file, that belong to nothing that is whole.
  std::uint64_t chunks_lost =
      0;                    ///< Chunks that were there, and whose contents are not as they were.
  bool is_cut_off = false;  ///< It has no proper end: its program was killed, or the disk full.
  /// Whether anything is.
  [[nodiscard]] bool any() const noexcept {
    return bytes_skipped > 0 || chunks_lost > 0 || is_cut_off;
  }
};

/// How a recording is read.
struct reading_options {
  /// What was recorded from `from_ns` on and before `to_ns`, since the beginning of the recording.
  std::int64_t from_ns = 0;
  std::int64_t to_ns = std::numeric_limits<std::int64_t>::max();
};

/// Reads one file. *Single thread.* Memory stays bounded whatever the file claims: one chunk packed and
/// one unpacked, of at most 64 MiB. With `from_ns` it begins at the right chunk, by the index where the
/// file has one.
class G4LIDAR_API recording_reader {
 public:
  /// Opens the file and finds the first thing that was recorded. Fails with bad_file where it is no
  /// recording of a lidar or holds nothing that is whole; with system.
  [[nodiscard]] static result<recording_reader> open(std::string_view path,
                                                     const reading_options& options = {});

  recording_reader(recording_reader&&) noexcept;
  recording_reader& operator=(recording_reader&&) noexcept;
  ~recording_reader();

  /// The next thing; nothing at the end. Where bytes are missing it gives a note `gap`. Fails with
  /// system, where the file can be read no further.
  [[nodiscard]] result<std::optional<recorded_item>> next() noexcept;

  /// What is known of the lidar: from the metadata, or what it said first. As far as has been read,
  /// where the file was cut off.
  [[nodiscard]] const std::optional<recorded_device>& device() const noexcept;
  /// Of this file; only where it was closed.
  [[nodiscard]] const std::optional<recorded_digest>& digest() const noexcept;
  /// When the first thing was recorded.
  [[nodiscard]] std::int64_t first_ns() const noexcept;
  /// When the last thing was recorded; 0 where the file was cut off.
  [[nodiscard]] std::int64_t last_ns() const noexcept;
  /// What is wrong with as much as has been read.
  [[nodiscard]] const recording_damage& damage() const noexcept;
  /// How far in the file it is: for a progress bar.
  [[nodiscard]] std::uint64_t position() const noexcept;
  /// How long the file is.
  [[nodiscard]] std::uint64_t size() const noexcept;

 private:
  friend struct recording_access;  // opens what is no file
  class G4LIDAR_HIDDEN file_reader;
  explicit recording_reader(std::unique_ptr<file_reader> made) noexcept;
  std::unique_ptr<file_reader> made_;
};

}  // namespace g4lidar
