// SPDX-License-Identifier: MIT
// The implementation of recording_writer: the chunk being filled, and its file.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "coverage.hpp"
#include "g4lidar/core/wall_clock.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/recording/writer.hpp"
#include "mcap_file.hpp"
#include "messages.hpp"
#include "metadata.hpp"
#include "numbered_path.hpp"
#include "packer.hpp"
#include "scan_ranges.hpp"

namespace g4lidar {

/// The wall clock minus the clock of the transport.
class wall_offset {
 public:
  /// It is given: the transport has a time of its own.
  void set(std::int64_t ahead_ns) noexcept {
    is_given_ = true;
    ahead_ns_ = ahead_ns;
  }
  /// Measures it, unless it is given.
  void update() noexcept {
    if (!is_given_) ahead_ns_ = wall_clock().ahead().count();
  }
  [[nodiscard]] std::int64_t ahead_ns() const noexcept { return ahead_ns_; }
  /// The wall clock at this time of the transport.
  [[nodiscard]] std::int64_t at(std::int64_t time_ns) const noexcept {
    return detail::saturating_add(time_ns, ahead_ns_);
  }

 private:
  std::int64_t ahead_ns_ = wall_clock().ahead().count();
  bool is_given_ = false;
};

/// The first failure of a series, until the caller takes it.
class trouble_report {
 public:
  void add(const result<void>& done) noexcept {
    if (!done && !std::exchange(is_in_series_, true)) first_ = done.error();
  }
  /// The next failure is a new one.
  void end() noexcept { is_in_series_ = false; }
  [[nodiscard]] std::optional<error> take() noexcept { return std::exchange(first_, std::nullopt); }

 private:
  std::optional<error> first_;
  bool is_in_series_ = false;
};

/// *Single thread.*
class recording_writer::file_writer {
 public:
  file_writer(mcap::mcap_file first, std::string_view path, const recording_options& options);

  void put_bytes(direction flow, bytes data, std::int64_t time_ns) noexcept;
  void event(const recorded_event& what) noexcept;
  void scan(const g4lidar::scan& revolution) noexcept;
  void odometry(const stamped_odometry& what) noexcept;
  void points(std::span<const point> delivered) noexcept { points_.add(delivered); }
  void device(const recorded_device& known) noexcept;
  void metadata(std::string_view name,
                std::span<const std::pair<std::string, std::string>> words) noexcept;
  /// What sends the bytes: the file begins again if it is empty and for another model.
  [[nodiscard]] result<void> take_model(const model& model);
  void set_wall_clock(std::int64_t ahead_ns) noexcept { wall_.set(ahead_ns); }
  result<void> flush() noexcept;
  result<void> close() noexcept;

  [[nodiscard]] std::optional<error> take_error() noexcept { return trouble_.take(); }
  [[nodiscard]] recording_counts counts() const noexcept {
    recording_counts all = counts_;
    all.file_bytes = closed_bytes_ + file_->size();
    return all;
  }
  [[nodiscard]] recorded_digest digest() const noexcept {
    return {payload_.value(), points_.count() > 0 ? points_.value() : 0, points_.count()};
  }
  /// The current file. keep(): there is more in it than attempts to open a lidar.
  [[nodiscard]] new_file& place() noexcept { return file_->place(); }

 private:
  /// If there is no memory, the chunk is lost.
  template <class Work>
  result<void> guarded(Work work) noexcept;
  template <class Put>
  void put(mcap::channel_id id, std::int64_t time_ns, std::size_t size, Put put) noexcept;
  [[nodiscard]] bool has_channel(mcap::channel_id id) noexcept;
  void begin_chunk(std::int64_t time_ns);
  [[nodiscard]] result<void> add_transform();
  [[nodiscard]] result<void> end_chunk();
  [[nodiscard]] result<bytes> pack();
  [[nodiscard]] result<void> rotate();
  [[nodiscard]] result<void> end_file(bool is_only_one);
  void lose_chunk() noexcept;

  recording_options options_;
  numbered_paths further_;
  std::unique_ptr<mcap::mcap_file> file_;
  mcap::channel_set channels_;  // of the current file
  mcap::open_chunk chunk_;
  std::optional<mcap::packer> packer_;
  scan_ranges ranges_;
  bool is_closed_ = false;

  mcap::transport_state transport_;
  std::optional<recorded_device> device_;
  std::array<std::uint32_t, mcap::topic_count> sequences_{};
  wall_offset wall_;
  coverage covered_;
  std::int64_t last_ns_ = 0;  // of all items

  recording_counts counts_;
  std::uint64_t closed_bytes_ = 0;  // of the files before this one
  payload_digest payload_;          // of all files
  point_digest points_;
  trouble_report trouble_;
};

}  // namespace g4lidar
