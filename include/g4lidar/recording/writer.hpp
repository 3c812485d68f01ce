// SPDX-License-Identifier: MIT
// Recordings: the bytes of a connection to a lidar, in MCAP files that other tools can also open; from any moment to any
// other, too.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/model_record.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/filter/too_near.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// Whether the chunks of a file are compressed.
enum class packing : std::uint8_t { none, zstd };

/// Whether this library was built with zstd; without it, `packing::zstd` is a bad_option.
[[nodiscard]] G4LIDAR_API bool has_zstd() noexcept;

/// How a recording is written. All members have defaults.
struct recording_options {
  /// What sends the bytes; valid as long as the writer. Null: what the first connector that recorded()
  /// wraps states, and else a G4.
  const g4lidar::model* model = nullptr;
  packing packed = packing::none;
  /// Whether an existing file may be replaced. It remains until there is something to replace it by: what a caller
  /// records, or bytes and the beginning of a scan. Attempts to open a lidar leave it as it is.
  bool overwrite = false;

  /// A new file is begun, beside the first one, before a file becomes larger than this or lasts
  /// this long; 0: never. `walk.mcap` is followed by `walk-0001.mcap`, or by the next number without a
  /// file: such a file is never replaced. Each file is complete by itself. At least 1 MiB and 1 s.
  std::uint64_t rotate_bytes = 0;
  std::chrono::seconds rotate_time{0};

  /// Data is passed to the system at least this often, so a crash loses at most this much; 10 ms to
  /// 10 s. Measured with the times of the recorded data: if nothing arrives there is nothing to
  /// lose, but see flush().
  std::chrono::milliseconds chunk_time{500};

  /// The topic of the LaserScan messages, a full ROS name: `/front/scan`. At most 255 bytes, and
  /// different from the topics of the recording itself.
  std::string topic = "/scan";
  std::string frame_id = "laser";  ///< Of the LaserScan and PointCloud2 messages.
  /// The number of ranges in each LaserScan, 1 to 65536; by default default_bins() of the scan's model.
  std::optional<std::uint32_t> scan_bins{};
  bool scans = true;  ///< Whether revolutions are recorded as LaserScan messages.
  /// The order of the ranges of a LaserScan. In the order of time `frame_id` is a frame with z down.
  scan_order order = scan_order::angle;
  /// How the ranges of a LaserScan are filled; its frame is that of `order`.
  grid_options grid{};
  /// Whether mark_near() flags the points of a LaserScan first, and its limits. Without it no direction is flagged.
  std::optional<near_limits> near{};
  /// The topic of PointCloud2 messages, one for each revolution; like `topic`, and different from it.
  /// Empty: there are none.
  std::string points_topic{};

  /// How the lidar is fixed to the robot: written as the transform from `robot_frame_id` to
  /// `frame_id`, once at the beginning of each file, on /tf_static. In the order of time the
  /// transform also contains the half turn of the frame with z down.
  std::optional<mounting> mount{};
  std::string robot_frame_id = "base_link";  ///< Also of the Odometry messages. At most 255 bytes.
  std::string odometry_frame_id = "odom";    ///< Of the Odometry messages. At most 255 bytes.
  bool keep_odometry = true;  ///< Whether the odometry of a replayed recording is recorded again.
};

/// Counts since create(), over all files.
struct recording_counts {
  std::uint64_t bytes_from_device = 0;
  std::uint64_t bytes_to_device = 0;
  std::uint64_t readings = 0;  ///< Messages of bytes from the device.
  std::uint64_t scans = 0;     ///< LaserScan messages.
  std::uint64_t odometry = 0;  ///< Odometry messages.
  std::uint64_t chunks = 0;    ///< Written.
  std::uint64_t files = 0;
  std::uint64_t file_bytes = 0;  ///< Written to all of them.
  std::uint64_t bytes_lost = 0;  ///< From and to the device, in chunks that could not be written.
  std::uint64_t chunks_lost = 0;
};

/// Writes recordings. *Single thread.* *Allocates on open*, when a new file is begun, and
/// occasionally for the list of its chunks. Each chunk is passed to the system as a whole, when it
/// is full or its time has passed; call flush() if no more data arrives. docs/recordings.md
/// describes the format.
///
/// Recording functions never fail: if the disk is full, chunks are left out and counted, the
/// written part stays valid, and take_error() returns the reason, once until writing succeeds
/// again.
class G4LIDAR_API recording_writer {
 public:
  /// Creates the file `path`. Fails with bad_option, or with system: EEXIST if it exists already.
  [[nodiscard]] static result<recording_writer> create(std::string_view path,
                                                       const recording_options& options = {});

  recording_writer(recording_writer&&) noexcept;
  recording_writer& operator=(recording_writer&&) noexcept;
  /// Like close().
  ~recording_writer();

  /// Records bytes of one read, and their arrival time: nanoseconds of the transport's clock. Reads
  /// the wall clock, but see set_wall_clock().
  void from_device(bytes data, std::int64_t time_ns) noexcept;
  /// The same for bytes that were sent.
  void to_device(bytes data, std::int64_t time_ns) noexcept;
  /// Records any other event; for `sent` use to_device().
  void event(const recorded_event& what) noexcept;
  /// Records a revolution, as a LaserScan and a PointCloud2, according to the options.
  void scan(const g4lidar::scan& revolution) noexcept;
  /// Records odometry of the robot, as an Odometry message on /odom. Its time is of the same clock as
  /// the other times, and may be before or after theirs. Ignored before the first bytes or event, and if a number is not
  /// at most max_odometry_value in magnitude.
  void odometry(const stamped_odometry& what) noexcept;
  /// Adds delivered points, in order, to their digest; the points are not stored.
  void points(std::span<const point> delivered) noexcept;
  /// Identity and settings of the lidar, for the metadata of this file and of those that follow.
  void device(const recorded_device& known) noexcept;
  /// Adds a record of words to the current file: metadata of this name, which must not begin with
  /// "g4lidar.device" or "g4lidar.digest". Readers of MCAP show it; a replay ignores it.
  void metadata(std::string_view name,
                std::span<const std::pair<std::string, std::string>> words) noexcept;
  /// From now on the wall clock is the transport's clock plus `ahead_ns`; for transports with a
  /// time of their own: simulations and recordings.
  void set_wall_clock(std::int64_t ahead_ns) noexcept;

  /// Ends the chunk, so that everything is passed to the system. May wait for the disk. Error:
  /// system.
  [[nodiscard]] result<void> flush() noexcept;
  /// Ends the file with its summary and digests. After that every function does nothing. May wait for
  /// the disk. Error: system.
  [[nodiscard]] result<void> close() noexcept;

  /// Removes the current file instead of ending it; an older one that it has not replaced remains. Also after close().
  /// After that every function does nothing.
  void discard() noexcept;

  /// Why something could not be written, once for each failure; nothing otherwise.
  [[nodiscard]] std::optional<error> take_error() noexcept;
  /// All counts as they are now.
  [[nodiscard]] recording_counts counts() const noexcept;
  /// The digest of everything so far, in all files.
  [[nodiscard]] recorded_digest digest() const noexcept;
  /// The path of the current file. Valid until the next call of any function.
  [[nodiscard]] std::string_view path() const noexcept;

 private:
  friend result<std::unique_ptr<connector>> recorded(std::unique_ptr<connector> connector,
                                                     recording_writer& into);
  class G4LIDAR_HIDDEN file_writer;
  template <class Call>
  G4LIDAR_HIDDEN void keep(Call call) noexcept;
  explicit recording_writer(std::unique_ptr<file_writer> made) noexcept;
  std::unique_ptr<file_writer> made_;
};

/// `connector`, with recording: the bytes that are read and sent, and when its transports open and
/// break. The writer must outlive the result; it may be moved, and must be used by the
/// same thread. Recording a replayed recording gives an equal recording. Fails with bad_option if
/// `connector` states another model than the options of the writer, or than what it has recorded, or plays the file that
/// is to be replaced; with system.
[[nodiscard]] G4LIDAR_API result<std::unique_ptr<connector>> recorded(
    std::unique_ptr<connector> connector, recording_writer& into);

class recording_writer;

/// Observes a connection, and records it while it is on. A recording that begins in the middle of a scan states what
/// is set at that moment. *Single thread*, that of the lidar.
class G4LIDAR_API recording_switch {
 public:
  recording_switch();
  recording_switch(const recording_switch&) = delete;
  recording_switch& operator=(const recording_switch&) = delete;
  /// Off. A connector of observe() is destroyed before.
  ~recording_switch();

  /// `from`, observed: for lidar_options::wrap. This outlives the result. A recording that is played is returned as it
  /// is: nothing of it is recorded.
  [[nodiscard]] std::unique_ptr<connector> observe(std::unique_ptr<connector> from);

  /// Records into `to`, which must outlive it, until off(). False, and nothing is recorded, without a connection.
  [[nodiscard]] bool on(recording_writer& to) noexcept;
  /// Ends it; the writer is not closed.
  void off() noexcept;

  /// The time of the latest bytes or event of the connection; nothing without a connection.
  [[nodiscard]] std::optional<std::int64_t> latest_ns() const noexcept;

 private:
  class G4LIDAR_HIDDEN observer;
  std::unique_ptr<observer> observer_;
};

}  // namespace g4lidar
