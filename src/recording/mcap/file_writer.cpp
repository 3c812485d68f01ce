// SPDX-License-Identifier: MIT
#include "file_writer.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <new>
#include <utility>

#include "g4lidar/message/ros_messages.hpp"

namespace g4lidar {
namespace {

/// Bytes in one message; a driver reads fewer at a time.
constexpr std::size_t largest_piece = std::size_t{64} << 10U;
/// Size of a message of any kind without its data.
constexpr std::size_t message_room = 2048;
/// Size of a point in a PointCloud2, with its intensity.
constexpr std::size_t point_room = 28;

std::int64_t ns_of(std::chrono::nanoseconds time) noexcept { return time.count(); }

std::string hexadecimal(std::uint64_t value) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

}  // namespace

using mcap::channel_id;

recording_writer::file_writer::file_writer(mcap::mcap_file first, std::string_view path,
                                           const recording_options& options)
    : options_(options),
      further_(path),
      file_(std::make_unique<mcap::mcap_file>(std::move(first))),
      channels_(options),
      ranges_(options) {
  if (options.packed == packing::zstd) packer_.emplace(std::size_t{1} << 20U);
  counts_.files = 1;
}

// ---- recorded items ----------------------------------------------------------------------------

template <class Work>
result<void> recording_writer::file_writer::guarded(Work work) noexcept {
  if (is_closed_) return {};
  try {
    auto done = work();
    trouble_.add(done);
    return done;
  } catch (const std::bad_alloc&) {
    result<void> failed = failure(task::writing, problem::system, file_->path(), ENOMEM);
    lose_chunk();
    trouble_.add(failed);
    return failed;
  }
}

/// One message of about `size` bytes, which `put` writes. Chunks and files are divided by the times of
/// all items but odometry, which may be of any time.
template <class Put>
void recording_writer::file_writer::put(channel_id id, std::int64_t time_ns, std::size_t size,
                                        Put put) noexcept {
  const std::int64_t item_ns = id == channel_id::odometry ? last_ns_ : time_ns;
  last_ns_ = std::max(last_ns_, item_ns);
  static_cast<void>(guarded([&]() -> result<void> {
    result<void> ended;
    const bool is_due = covered_.chunk_age_ns(item_ns) >= ns_of(options_.chunk_time);
    if (!chunk_.is_empty() && (is_due || !chunk_.has_room_for(size + message_room))) {
      ended = end_chunk();
    }
    if (chunk_.is_empty()) begin_chunk(item_ns);
    std::uint32_t& sequence = sequences_[mcap::index_of(id)];
    covered_.add(item_ns);
    chunk_.begin_message(id, sequence++, wall_.at(time_ns));
    put(chunk_.text());
    chunk_.end_message();
    return ended;
  }));
}

void recording_writer::file_writer::put_bytes(direction flow, bytes data,
                                              std::int64_t time_ns) noexcept {
  if (is_closed_) return;
  payload_.add(flow, data);
  const bool is_from_device = flow == direction::from_device;
  (is_from_device ? counts_.bytes_from_device : counts_.bytes_to_device) += data.size();
  while (!data.empty()) {
    const bytes piece = data.first(std::min(data.size(), largest_piece));
    data = data.subspan(piece.size());
    if (is_from_device) ++counts_.readings;
    put(is_from_device ? channel_id::from_device : channel_id::to_device, time_ns, piece.size(),
        [&](mcap::record_text& out) {
          mcap::put_recorded_bytes(out, piece, time_ns);
          covered_.add(flow, piece);
        });
  }
}

void recording_writer::file_writer::event(const recorded_event& what) noexcept {
  if (what.what == recorded_event::kind::sent) {
    return put_bytes(direction::to_device, what.data, what.time_ns);
  }
  if (what.what == recorded_event::kind::odometry) {
    if (options_.keep_odometry) odometry(what.odometry);
    return;
  }
  if (what.what == recorded_event::kind::begun) place().keep();
  if (what.what != recorded_event::kind::state) {  // each chunk begins with one
    put(channel_id::events, what.time_ns, 0,
        [&](mcap::record_text& out) { mcap::put_event(out, what, wall_.ahead_ns()); });
  }
  transport_.take(what);
}

void recording_writer::file_writer::scan(const g4lidar::scan& revolution) noexcept {
  if (is_closed_ || revolution.points.empty()) return;
  const std::span<const point> points = revolution.points;
  message_header header{.frame_id = options_.frame_id,
                        .duration_ns = revolution.duration_ns,
                        .order = options_.order,
                        .model = revolution.model};
  const auto put_stamped = [&](channel_id id, std::size_t size, auto put_message) {
    put(id, last_ns_, size, [&](mcap::record_text& out) {
      header.stamp_ns = wall_.at(points.front().time_ns);
      put_message(out.memory());
    });
  };
  if (options_.scans) {
    ++counts_.scans;
    ranges_.fill(revolution, options_, header);
    put_stamped(channel_id::scan, 2 * ranges_.ranges_m().size_bytes(),
                [&](auto& out) { put_laser_scan(ranges_.ranges_m(), header, out); });
  }
  if (channels_.has(channel_id::points)) {
    put_stamped(channel_id::points, points.size() * point_room,
                [&](auto& out) { put_point_cloud2(points, header, out); });
  }
}

/// Whether the file has the channel, which is added if necessary.
bool recording_writer::file_writer::has_channel(channel_id id) noexcept {
  if (channels_.has(id)) return true;
  static_cast<void>(guarded([&]() -> result<void> {
    auto done = end_chunk();
    mcap::channel_set more = channels_;
    more.add(id);
    if (done) done = file_->extend(more);
    if (done) channels_ = more;
    return done;
  }));
  return channels_.has(id);
}

void recording_writer::file_writer::odometry(const stamped_odometry& what) noexcept {
  const auto& [x_m, y_m, yaw_rad] = what.pose;
  const auto& [forward, leftward, turn] = what.twist;
  const std::array values{x_m, y_m, yaw_rad, forward, leftward, turn};
  const bool is_possible = std::ranges::all_of(
      values, [](double value) { return std::fabs(value) <= max_odometry_value; });
  const bool has_begun =
      transport_.is_known || counts_.bytes_from_device + counts_.bytes_to_device > 0;
  if (is_closed_ || !is_possible || !has_begun || !has_channel(channel_id::odometry)) return;
  ++counts_.odometry;
  put(channel_id::odometry, what.time_ns, 0, [&](mcap::record_text& out) {
    put_odometry({.stamp_ns = wall_.at(what.time_ns),
                  .frame_id = options_.odometry_frame_id,
                  .child_frame_id = options_.robot_frame_id,
                  .pose = what.pose,
                  .twist = what.twist},
                 out.memory());
  });
}

void recording_writer::file_writer::device(const recorded_device& known) noexcept {
  static_cast<void>(guarded([&]() -> result<void> {
    device_ = mcap::joined(device_.value_or(recorded_device{}), known);
    metadata(mcap::device_metadata, mcap::words_of(*device_));
    return {};
  }));
}

/// Behind the items that were recorded before it.
void recording_writer::file_writer::metadata(
    std::string_view name, std::span<const std::pair<std::string, std::string>> words) noexcept {
  static_cast<void>(guarded([&]() -> result<void> {
    if (!chunk_.is_empty()) {
      if (auto ended = end_chunk(); !ended) return ended;
    }
    return file_->add_metadata(name, mcap::word_map(words.begin(), words.end()));
  }));
}

result<void> recording_writer::file_writer::take_model(const model& lidar_model) {
  const model& now = channels_.model();
  if (is_closed_ || now == lidar_model) return {};
  const bool has_begun = transport_.is_known || !chunk_.is_empty() || !file_->is_empty();
  if (options_.model != nullptr || has_begun) {
    return failure(task::opening, problem::bad_option,
                   "model: " + std::string(lidar_model.word) + ", and the recording states " +
                       std::string(now.word));
  }
  channels_.set_model(lidar_model);
  return file_->begin(channels_);
}

// ---- chunks and files ---------------------------------------------------------------------------

/// Each begins with everything that a reader needs without the earlier ones.
void recording_writer::file_writer::begin_chunk(std::int64_t time_ns) {
  wall_.update();
  covered_.begin_chunk(time_ns, !file_->has_chunks());
  channels_.put_channels(chunk_.text());
  if (!transport_.is_known) return;
  chunk_.begin_message(channel_id::events, sequences_[mcap::index_of(channel_id::events)]++,
                       wall_.at(time_ns));
  mcap::put_event(chunk_.text(), transport_.as_event(time_ns), wall_.ahead_ns());
  chunk_.end_message();
}

result<bytes> recording_writer::file_writer::pack() {
  if (!packer_) return bytes{};
  const bytes packed = packer_->pack(chunk_.records());
  if (packed.empty()) return failure(task::writing, problem::system, file_->path(), ENOMEM);
  return packed;
}

/// Writes the chunk to the file, or counts it as lost; empties it in any case.
result<void> recording_writer::file_writer::end_chunk() {
  if (chunk_.is_empty()) return {};
  const auto packed = pack();
  result<void> rotated;
  if (packed) {
    const std::uint64_t after = file_->closed_size() + 2 * chunk_.records().size();
    const bool is_full = options_.rotate_bytes != 0 && after > options_.rotate_bytes;
    const std::int64_t rotate_ns = ns_of(options_.rotate_time);
    const bool is_old = rotate_ns != 0 && covered_.length_ns() >= rotate_ns;
    const bool may_rotate = place().is_kept() && file_->has_chunks();
    if (may_rotate && (is_full || is_old)) rotated = rotate();
  }
  if (packed && options_.mount && !file_->has_chunks()) {
    if (auto first = add_transform(); !first) rotated = first;
  }
  result<void> added = packed ? file_->add(chunk_, *packed) : tl::unexpected(packed.error());
  if (!added) {
    lose_chunk();
    return added;
  }
  chunk_.clear();
  ++counts_.chunks;
  covered_.keep_chunk();
  if (rotated) rotated = file_->settle();
  if (rotated) trouble_.end();
  return rotated;
}

/// The first chunk of each file: how the lidar is fixed to the robot.
result<void> recording_writer::file_writer::add_transform() {
  mounting place =
      *options_.mount;  // NOLINT(bugprone-unchecked-optional-access): the caller checks
  if (options_.order == scan_order::time) place.upside_down = !place.upside_down;
  const auto begin_ns = static_cast<std::int64_t>(chunk_.first_ns());
  mcap::open_chunk first;
  channels_.put_channels(first.text());
  constexpr auto id = channel_id::tf_static;
  first.begin_message(id, sequences_[mcap::index_of(id)]++, begin_ns);
  put_tf_message({.stamp_ns = begin_ns,
                  .frame_id = options_.robot_frame_id,
                  .child_frame_id = options_.frame_id,
                  .place = place},
                 first.text().memory());
  first.end_message();
  auto added = file_->add(first, {});
  if (added) ++counts_.chunks;
  return added;
}

void recording_writer::file_writer::lose_chunk() noexcept {
  chunk_.clear();
  ++counts_.chunks_lost;
  counts_.bytes_lost += covered_.lose_chunk();
}

/// The new file is created first: if that fails, the old one is continued. An existing file stays: its number is left
/// out.
result<void> recording_writer::file_writer::rotate() {
  const auto next = [this] {
    while (true) {
      auto made = mcap::mcap_file::create(further_.next(), channels_, false);
      if (made || made.error().system_errno() != EEXIST) return made;
    }
  };
  auto made = next();
  if (!made) return tl::unexpected(made.error());
  made->place().keep();
  auto ended = end_file(false);
  ++counts_.files;
  closed_bytes_ += file_->size();
  file_ = std::make_unique<mcap::mcap_file>(std::move(*made));
  covered_.begin_file(mcap::payload_of(chunk_.records()));
  if (ended && device_)
    ended = file_->add_metadata(mcap::device_metadata, mcap::words_of(*device_));
  return ended;
}

result<void> recording_writer::file_writer::end_file(bool is_only_one) {
  mcap::word_map words{{"payload", hexadecimal(covered_.payload().value())},
                       {"first_ns", std::to_string(covered_.first_ns())},
                       {"last_ns", std::to_string(covered_.last_ns())}};
  const model* const last = device_ ? device_->read_as() : nullptr;
  const bool has_changed = last != nullptr && *last != channels_.model();
  // They continue from file to file, and a player may change the model a packet later.
  if (is_only_one && points_.count() > 0 && !has_changed) {
    words.emplace_back("points", hexadecimal(points_.value()));
    words.emplace_back("point_count", std::to_string(points_.count()));
    words.emplace_back("computed_with", computed_with());
    words.emplace_back("points_version", mcap::points_version);
  }
  auto done = file_->add_metadata(mcap::digest_metadata, words);
  if (auto closed = file_->close(); done) done = closed;
  if (auto settled = file_->settle(); done) done = settled;
  return done;
}

result<void> recording_writer::file_writer::flush() noexcept {
  place().keep();
  return guarded([&]() -> result<void> {
    auto ended = end_chunk();
    auto settled = file_->settle();
    return ended ? settled : ended;
  });
}

result<void> recording_writer::file_writer::close() noexcept {
  auto done = guarded([&]() -> result<void> {
    auto ended = end_chunk();
    auto closed = end_file(counts_.files == 1);
    return ended ? closed : ended;
  });
  place().drop_if_waiting();
  is_closed_ = true;
  return done;
}

}  // namespace g4lidar
