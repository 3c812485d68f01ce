// SPDX-License-Identifier: MIT
// The public interface of the writer, and its valid options.
#include "g4lidar/recording/writer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "recording/mcap/file_writer.hpp"

namespace g4lidar {
namespace {

constexpr std::size_t largest_grid = 65536;
constexpr std::size_t longest_name = 255;
constexpr std::uint64_t least_rotate_bytes = std::uint64_t{1} << 20U;

/// A full ROS name: parts of letters, digits and single underscores, none of which begins with a
/// digit.
bool is_topic(std::string_view name) noexcept {
  const auto is_digit = [](char of) { return of >= '0' && of <= '9'; };
  const auto is_letter = [](char of) {
    return (of >= 'a' && of <= 'z') || (of >= 'A' && of <= 'Z');
  };
  if (name.empty() || name.size() > longest_name || name.front() != '/') return false;
  char before = 0;
  for (const char each : name) {
    if (!is_digit(each) && !is_letter(each) && each != '_' && each != '/') return false;
    if (before == '/' && (each == '/' || is_digit(each))) return false;
    if (before == '_' && each == '_') return false;
    before = each;
  }
  return before != '/';
}

/// Names with another meaning for a reader.
bool is_our_own(std::string_view name) noexcept {
  const std::string_view in_group =
      name.substr(std::min(name.size(), mcap::connection_prefix.size()));
  if (name.starts_with(mcap::connection_prefix) && in_group.starts_with(mcap::model_version)) {
    return true;
  }
  return std::ranges::any_of(mcap::all_topics(), [&](const mcap::topic_words& known) {
    return !known.is_named_by_options() && known.name == name;
  });
}

std::optional<error> problem_with(const recording_options& options) noexcept {
  using namespace std::chrono_literals;
  const auto bad = [](std::string_view what) {
    return error(task::configuring, problem::bad_option, what);
  };
  if (options.packed == packing::zstd && !has_zstd()) return bad("packed: built without zstd");
  if (options.chunk_time < 10ms || options.chunk_time > 10s)
    return bad("chunk_time: 10 ms to 10 s");
  if (options.rotate_bytes != 0 && options.rotate_bytes < least_rotate_bytes) {
    return bad("rotate_bytes: 0, or at least 1048576");
  }
  if (options.rotate_time < 0s || options.rotate_time > 10 * 365 * 24h) {
    return bad("rotate_time: 0, or at least 1 s");
  }
  if (options.scan_bins && (*options.scan_bins == 0 || *options.scan_bins > largest_grid))
    return bad("scan_bins: 1 to 65536");
  if (!is_topic(options.topic)) return bad("topic: a whole name as ROS has them, like /front/scan");
  if (is_our_own(options.topic)) return bad("topic: one of the recording's own");
  if (!options.points_topic.empty()) {
    if (!is_topic(options.points_topic)) return bad("points_topic: a whole name as ROS has them");
    if (is_our_own(options.points_topic) || options.points_topic == options.topic) {
      return bad("points_topic: one of the recording's own");
    }
  }
  for (const std::string& name :
       {options.frame_id, options.robot_frame_id, options.odometry_frame_id}) {
    if (name.size() > longest_name) return bad("frame_id: at most 255 bytes");
  }
  if (options.mount) {
    const auto& [x_m, y_m, yaw_rad] = options.mount->pose;
    const bool is_good = std::isfinite(x_m) && std::isfinite(y_m) && std::isfinite(yaw_rad);
    if (!is_good) return bad("mount: finite numbers");
  }
  return std::nullopt;
}

}  // namespace

// A moved-from writer behaves like a closed one.

recording_writer::recording_writer(std::unique_ptr<file_writer> made) noexcept
    : made_(std::move(made)) {}
recording_writer::recording_writer(recording_writer&&) noexcept = default;
recording_writer& recording_writer::operator=(recording_writer&& other) noexcept {
  if (this != &other) static_cast<void>(close());
  made_ = std::move(other.made_);
  return *this;
}
recording_writer::~recording_writer() { static_cast<void>(close()); }

result<recording_writer> recording_writer::create(std::string_view path,
                                                  const recording_options& options) {
  if (const auto wrong = problem_with(options)) return tl::unexpected(*wrong);
  auto first =
      mcap::mcap_file::create(std::string(path), mcap::channel_set(options), options.overwrite);
  if (!first) return tl::unexpected(first.error());
  return recording_writer(std::make_unique<file_writer>(std::move(*first), path, options));
}

template <class Call>
void recording_writer::keep(Call call) noexcept {
  if (!made_) return;
  made_->place().keep();
  call(*made_);
}

void recording_writer::from_device(bytes data, std::int64_t time_ns) noexcept {
  keep([&](file_writer& to) { to.put_bytes(direction::from_device, data, time_ns); });
}
void recording_writer::to_device(bytes data, std::int64_t time_ns) noexcept {
  keep([&](file_writer& to) { to.put_bytes(direction::to_device, data, time_ns); });
}
void recording_writer::event(const recorded_event& what) noexcept {
  keep([&](file_writer& to) { to.event(what); });
}
void recording_writer::scan(const g4lidar::scan& revolution) noexcept {
  keep([&](file_writer& to) { to.scan(revolution); });
}
void recording_writer::odometry(const stamped_odometry& what) noexcept {
  keep([&](file_writer& to) { to.odometry(what); });
}
void recording_writer::points(std::span<const point> delivered) noexcept {
  keep([&](file_writer& to) { to.points(delivered); });
}
void recording_writer::device(const recorded_device& known) noexcept {
  keep([&](file_writer& to) { to.device(known); });
}
void recording_writer::metadata(
    std::string_view name, std::span<const std::pair<std::string, std::string>> words) noexcept {
  keep([&](file_writer& to) { to.metadata(name, words); });
}
void recording_writer::set_wall_clock(std::int64_t ahead_ns) noexcept {
  if (made_) made_->set_wall_clock(ahead_ns);
}
result<void> recording_writer::flush() noexcept { return made_ ? made_->flush() : result<void>(); }
result<void> recording_writer::close() noexcept { return made_ ? made_->close() : result<void>(); }
void recording_writer::discard() noexcept {
  if (!made_) return;
  made_->place().remove();
  static_cast<void>(made_->close());
}
std::optional<error> recording_writer::take_error() noexcept {
  return made_ ? made_->take_error() : std::nullopt;
}
recording_counts recording_writer::counts() const noexcept {
  return made_ ? made_->counts() : recording_counts{};
}
recorded_digest recording_writer::digest() const noexcept {
  return made_ ? made_->digest() : recorded_digest{};
}
std::string_view recording_writer::path() const noexcept {
  return made_ ? std::string_view(made_->place().path()) : std::string_view();
}

}  // namespace g4lidar
