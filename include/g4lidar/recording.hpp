// SPDX-License-Identifier: MIT
// Recordings: what goes over a line to a lidar, kept in MCAP files that other tools open too.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "g4lidar/bytes.hpp"
#include "g4lidar/connector.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/line_note.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recorded_device.hpp"
#include "g4lidar/recording_digest.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// Whether the chunks of a file are packed.
enum class packing : std::uint8_t { none, zstd };

/// Whether this library was built with zstd; without it, `packing::zstd` is a bad_option.
[[nodiscard]] G4LIDAR_API bool has_zstd() noexcept;

/// How a recording is made. Nothing need be set.
struct recording_options {
  packing packed = packing::none;
  bool overwrite = false;  ///< Whether a file that is there already may be replaced.

  /// A new file is begun, beside the first one, before one grows beyond this or has taken this long;
  /// 0: never. `walk.mcap` is followed by `walk-0001.mcap`. Each is whole by itself. At least 1 MiB
  /// and 1 s.
  std::uint64_t rotate_bytes = 0;
  std::chrono::seconds rotate_time{0};

  /// What is recorded goes to the system at least as often, and after a crash at most that much is
  /// lost; 10 ms to 10 s. Told by the times of what is recorded: a line that brings nothing has
  /// nothing to lose, but see flush().
  std::chrono::milliseconds chunk_time{500};

  /// Where the LaserScan messages are, a whole name as ROS has them: `/front/scan`. At most 255 bytes,
  /// and not one of the recording's own.
  std::string topic = "/scan";
  std::string frame_id = "laser";  ///< Of the LaserScan messages.
  std::uint32_t scan_bins = 720;   ///< Ranges in each of them, 1 to 65536.
};

/// Counts since create(), over all files.
struct recording_counts {
  std::uint64_t bytes_from_device = 0;
  std::uint64_t bytes_to_device = 0;
  std::uint64_t readings = 0;  ///< Messages of bytes from the device.
  std::uint64_t scans = 0;     ///< LaserScan messages.
  std::uint64_t chunks = 0;    ///< Written.
  std::uint64_t files = 0;
  std::uint64_t file_bytes = 0;  ///< Written to all of them.
  std::uint64_t bytes_lost = 0;  ///< From and to the device, in chunks that could not be written.
  std::uint64_t chunks_lost = 0;
};

/// Writes recordings. *Single thread.* *Allocates on open*, when a new file is begun, and now and then
/// for the list of its chunks. Each chunk is handed to the system whole, when it is full or its time has
/// come; where a line falls silent, flush() does that. docs/recordings.md has the format.
///
/// Nothing that is recorded fails: where the disk is full, chunks are left out and counted, what was
/// written stays good, and take_error() tells why, once until it is over.
class G4LIDAR_API recording_writer {
 public:
  /// Begins the file `path`. Fails with bad_option, or with system: EEXIST where it is there already.
  [[nodiscard]] static result<recording_writer> create(std::string_view path,
                                                       const recording_options& options = {});

  recording_writer(recording_writer&&) noexcept;
  recording_writer& operator=(recording_writer&&) noexcept;
  /// As close().
  ~recording_writer();

  /// Bytes as they were read together, and when: nanoseconds of the line's clock. The wall
  /// clock is read here, but see set_wall_clock().
  void from_device(bytes data, std::int64_t time_ns) noexcept;
  /// The same for bytes that were sent.
  void to_device(bytes data, std::int64_t time_ns) noexcept;
  /// Anything else that happened; `sent` is to_device().
  void note(const line_note& what) noexcept;
  /// A revolution, as a LaserScan with its points in the robot's frame.
  void scan(const g4lidar::scan& revolution) noexcept;
  /// Points as they were delivered, in order: only their digest is kept.
  void points(std::span<const point> delivered) noexcept;
  /// Who it is and how it is set, for the metadata of this file and of those that follow.
  void device(const recorded_device& known) noexcept;
  /// From here on the wall clock is `ahead_ns` ahead of the line's, for lines with a time of their own:
  /// simulations and recordings.
  void set_wall_clock(std::int64_t ahead_ns) noexcept;

  /// Ends the chunk, so that all there is goes to the system.
  result<void> flush() noexcept;
  /// Ends the file, with its summary and digests. Again, or afterwards, everything does nothing.
  result<void> close() noexcept;

  /// Why something could not be written, once for each time that this began.
  [[nodiscard]] std::optional<error> take_error() noexcept;
  /// All counts as they are now.
  [[nodiscard]] recording_counts counts() const noexcept;
  /// Of everything so far, in all files.
  [[nodiscard]] recorded_digest digest() const noexcept;
  /// The file being written. Good until the next call of anything here.
  [[nodiscard]] std::string_view path() const noexcept;

 private:
  friend result<std::unique_ptr<connector>> recorded(std::unique_ptr<connector> line,
                                                     recording_writer& into);
  class G4LIDAR_HIDDEN file_writer;
  explicit recording_writer(std::unique_ptr<file_writer> made) noexcept;
  std::unique_ptr<file_writer> made_;
};

/// `line`, with everything that goes over it recorded: what is read, as it is read, what is sent, and
/// that it was opened and broke off. The writer outlives what this gives; it may be moved meanwhile,
/// and used by the same thread. A recording that is played is recorded as the same recording again.
[[nodiscard]] G4LIDAR_API result<std::unique_ptr<connector>> recorded(
    std::unique_ptr<connector> line, recording_writer& into);

}  // namespace g4lidar
