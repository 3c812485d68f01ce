// SPDX-License-Identifier: MIT
#include "g4lidar/motion/odometry_feed.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/recording/reader.hpp"

namespace g4lidar {
namespace {

/// Times of points that go back by less do so by the error of the clock.
constexpr std::int64_t least_way_back_ns = 100'000'000;
/// Points are a little older than their bytes, and rounds of a recording are further apart.
constexpr std::int64_t largest_age_ns = 5'000'000;

}  // namespace

result<std::vector<stamped_odometry>> recorded_odometry(const std::string& path,
                                                        const std::function<bool()>& is_cancelled) {
  auto reader = recording_reader::open(path, {.is_cancelled = is_cancelled});
  if (!reader) return tl::unexpected(reader.error());
  std::vector<stamped_odometry> all;
  const auto read = reader->for_each([&](const recorded_item& item) {
    if (item.what == recorded_item::kind::odometry) all.push_back(item.odometry);
    return !is_cancelled || !is_cancelled();
  });
  if (!read) return tl::unexpected(read.error());
  if (is_cancelled && is_cancelled()) return failure(task::reading, problem::cancelled, path);
  std::ranges::sort(all, {}, &stamped_odometry::time_ns);
  const auto same = std::ranges::unique(all, {}, &stamped_odometry::time_ns);
  all.erase(same.begin(), same.end());
  return all;
}

result<void> odometry_feed::load_recording(const std::string& path,
                                           const std::function<bool()>& is_cancelled) {
  all_.clear();
  auto found = recorded_odometry(path, is_cancelled);
  if (!found) return tl::unexpected(found.error());
  all_ = *std::move(found);
  return {};
}

void odometry_feed::shift(std::int64_t shift_ns) {
  for (stamped_odometry& each : all_) each.time_ns = detail::saturating_add(each.time_ns, shift_ns);
}

void odometry_feed::follow(const sim::simulated_source* carried) {
  robot_ = carried == nullptr ? nullptr : robot_of(*carried);
  if (robot_) coming_ = robot_();
  last_ns_ = std::numeric_limits<std::int64_t>::min();
  has_begun_ = false;
}

void odometry_feed::follow(player& played) {
  const std::int64_t before_ns = std::exchange(begin_ns_, played.begin_ns());
  if (std::exchange(player_, &played) != nullptr)
    shift(detail::saturating_sub(begin_ns_, before_ns));  // opened again
  has_begun_ = false;
}

void odometry_feed::follow_round(std::int64_t time_ns) {
  const std::int64_t begin_ns = player_->begin_ns();
  if (begin_ns == begin_ns_ || time_ns < detail::saturating_sub(begin_ns, largest_age_ns)) return;
  shift(detail::saturating_sub(begin_ns, std::exchange(begin_ns_, begin_ns)));
  has_begun_ = false;
}

void odometry_feed::follow(std::span<const point> points, const taker& take) {
  if (points.empty()) return;
  if (player_ != nullptr) follow_round(points.front().time_ns);
  const std::int64_t before_ns = std::exchange(points_ns_, points.front().time_ns);
  if (points_ns_ < detail::saturating_sub(before_ns, least_way_back_ns))
    has_begun_ = false;  // a seek
  if (all_.empty() && robot_) return follow_robot(points, take);
  if (all_.empty()) return;
  if (!std::exchange(has_begun_, true)) {
    ++begun_;
    const auto first =
        std::ranges::upper_bound(all_, points.front().time_ns, {}, &stamped_odometry::time_ns);
    next_ = static_cast<std::size_t>(first - all_.begin()) - (first == all_.begin() ? 0 : 1);
  }
  while (next_ < all_.size()) {
    if (next_ > 0 && all_[next_ - 1].time_ns >= points.back().time_ns) return;
    take(all_[next_++]);
  }
}

void odometry_feed::follow_robot(std::span<const point> points, const taker& take) {
  while (last_ns_ < points.back().time_ns) {
    const stamped_odometry at = std::exchange(coming_, robot_());
    last_ns_ = at.time_ns;
    // Of what was before the first point, only the last one is of use.
    if (!has_begun_ && coming_.time_ns <= points.front().time_ns) continue;
    if (!std::exchange(has_begun_, true)) ++begun_;
    take(at);
  }
}

}  // namespace g4lidar
