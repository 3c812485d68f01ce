// SPDX-License-Identifier: MIT
// The public interface of the driver.
#include "g4lidar/lidar.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "discovery/system_connector.hpp"
#include "driver.hpp"

namespace g4lidar {
namespace {

using std::chrono::milliseconds;

/// Limited so that its sum with a time of the clock does not overflow.
std::int64_t in_ns(milliseconds time) noexcept {
  constexpr milliseconds longest = std::chrono::hours(24 * 365);
  return std::chrono::nanoseconds(std::clamp(time, milliseconds(0), longest)).count();
}

error bad(std::string_view what) noexcept { return {task::configuring, problem::bad_option, what}; }

}  // namespace

std::optional<error> problem_with(const lidar_options& options) noexcept {
  const auto within = [](auto value, auto least, auto most) {
    return value >= least && value <= most;
  };
  if (options.baud == 0) return bad("baud: above 0");
  const auto may_be = [](const auto& setting) { return !setting || is_valid(*setting); };
  if (!may_be(options.ranging)) return bad("ranging: khz_4, khz_8 or khz_9");
  if (!may_be(options.frequency)) return bad("frequency: 500 to 1200 (5 to 12 Hz)");
  if (!may_be(options.direction)) return bad("direction: clockwise or counter_clockwise");
  if (!may_be(options.constant)) return bad("constant: on or off");
  if (!may_be(options.idle)) return bad("idle: on or off");
  if (!may_be(options.protection)) return bad("protection: on or off");
  if (options.pace > read_pace::revolutions) return bad("pace: automatic, packets or revolutions");
  using namespace std::chrono_literals;
  if (!within(options.longest_backoff, 1ms, 1000ms)) return bad("longest_backoff: 1 ms to 1 s");
  if (!within(options.answer_time, 10ms, 10'000ms)) return bad("answer_time: 10 ms to 10 s");
  if (!within(options.stall_time, 100ms, 60'000ms)) return bad("stall_time: 100 ms to 1 min");
  if (!within(options.batch, 0ms, 100ms)) return bad("batch: 0 to 100 ms");
  if (!within(options.transport_delay, 0ns, 1'000'000'000ns)) {
    return bad("transport_delay: 0 to 1 s");
  }
  return std::nullopt;
}

std::string_view name_of(lidar_event::kind what) noexcept {
  constexpr std::array<std::string_view, 11> names{
      "lost",        "reconnected", "found_scanning", "protection_starved", "protection_found_on",
      "spinning_up", "restarted",   "health_warning", "other_lidar",        "long_pause",
      "overflow"};
  return names[static_cast<std::size_t>(what)];
}

lidar::lidar(std::unique_ptr<driver> made) noexcept : driver_(std::move(made)) {}
lidar::lidar(lidar&&) noexcept = default;
lidar& lidar::operator=(lidar&&) noexcept = default;
lidar::~lidar() = default;

result<std::unique_ptr<connector>> connector_for(const lidar_options& options) {
  if (const auto problem = problem_with(options)) return tl::unexpected(*problem);
  return system_connector::make(options.device, options.baud);
}

result<lidar> lidar::open(const lidar_options& options) {
  auto from = connector_for(options);
  if (!from) return tl::unexpected(from.error());
  return open(std::move(*from), options);
}

result<lidar> lidar::open(std::string_view device) {
  lidar_options options;
  options.device = device;
  return open(options);
}

result<lidar> lidar::open(std::unique_ptr<connector> from, const lidar_options& options) {
  if (const auto problem = problem_with(options)) return tl::unexpected(*problem);
  auto made = std::make_unique<driver>(std::move(from), options);
  if (auto opened = made->open(); !opened) return tl::unexpected(opened.error());
  return lidar(std::move(made));
}

result<void> lidar::start() { return driver_ ? driver_->start() : moved_from(); }
result<void> lidar::stop() { return driver_ ? driver_->stop() : moved_from(); }
result<void> lidar::close() { return driver_ ? driver_->close() : result<void>(); }
void lidar::release() noexcept {
  if (driver_) driver_->release();
}
view_result<scan> lidar::next_scan(milliseconds timeout) {
  if (!driver_) return moved_from();
  return driver_->next_scan(in_ns(timeout));
}
view_result<std::span<const point>> lidar::next_points(milliseconds timeout) {
  if (!driver_) return moved_from();
  return driver_->next_points(in_ns(timeout));
}
const lidar_ring& lidar::points() const noexcept {
  return driver_ ? driver_->points() : empty_ring();
}
int lidar::native_handle() const noexcept { return driver_ ? driver_->native_handle() : -1; }
std::int64_t lidar::next_deadline_ns() const noexcept {
  return driver_ ? driver_->next_deadline_ns() : never_ns;
}
std::chrono::steady_clock::time_point lidar::next_deadline() const noexcept {
  using clock = std::chrono::steady_clock;
  return clock::time_point(std::chrono::nanoseconds(next_deadline_ns()));
}
result<void> lidar::process() { return driver_ ? driver_->process() : moved_from(); }
void lidar::wake() noexcept {
  if (driver_) driver_->wake();
}
result<answer> lidar::ask(const request& wanted, while_scanning how) {
  if (!driver_) return moved_from();
  return driver_->ask(wanted, how);
}
const device_information& lidar::information() const noexcept {
  static constexpr device_information none{};
  return driver_ ? driver_->information() : none;
}
std::string_view lidar::name() const noexcept { return driver_ ? driver_->name() : "closed"; }
bool lidar::is_scanning() const noexcept { return driver_ && driver_->is_scanning(); }
lidar_counts lidar::counts() const noexcept { return driver_ ? driver_->counts() : lidar_counts(); }
std::optional<lidar_event> lidar::next_event() noexcept {
  return driver_ ? driver_->next_event() : std::nullopt;
}

}  // namespace g4lidar
