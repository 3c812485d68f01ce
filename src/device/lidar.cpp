// SPDX-License-Identifier: MIT
// The public face of the driver.
#include "g4lidar/lidar.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "driver.hpp"
#include "system_connector.hpp"

namespace g4lidar {
namespace {

using std::chrono::milliseconds;

std::int64_t in_ns(milliseconds time) noexcept {
  constexpr milliseconds longest = std::chrono::hours(24 * 365);
  return std::chrono::nanoseconds(std::min(time, longest)).count();
}

error bad(std::string_view what) noexcept { return {task::configuring, problem::bad_option, what}; }

}  // namespace

std::optional<error> problem_with(const lidar_options& options) noexcept {
  const auto within = [](auto value, auto least, auto most) {
    return value >= least && value <= most;
  };
  if (options.baud == 0) return bad("baud: above 0");
  if (options.frequency &&
      !within(options.frequency->chz, min_scan_frequency_chz, max_scan_frequency_chz)) {
    return bad("frequency: 500 to 1200 (5 to 12 Hz)");
  }
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
  constexpr std::array<std::string_view, 8> names{
      "lost",      "reconnected",    "found_scanning", "protection_starved", "protection_found_on",
      "restarted", "health_warning", "overflow"};
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
  auto line = connector_for(options);
  if (!line) return tl::unexpected(line.error());
  return open(std::move(*line), options);
}

result<lidar> lidar::open(std::string_view device) {
  lidar_options options;
  options.device = device;
  return open(options);
}

result<lidar> lidar::open(std::unique_ptr<connector> line, const lidar_options& options) {
  if (const auto problem = problem_with(options)) return tl::unexpected(*problem);
  auto made = std::make_unique<driver>(std::move(line), options);
  if (auto opened = made->open(); !opened) return tl::unexpected(opened.error());
  return lidar(std::move(made));
}

result<void> lidar::start() { return driver_->start(); }
result<void> lidar::stop() { return driver_->stop(); }
result<void> lidar::close() { return driver_->close(); }
void lidar::release() noexcept { driver_->release(); }
result<scan> lidar::next_scan(milliseconds timeout) { return driver_->next_scan(in_ns(timeout)); }
result<std::span<const point>> lidar::next_points(milliseconds timeout) {
  return driver_->next_points(in_ns(timeout));
}
lidar_ring& lidar::points() noexcept { return driver_->points(); }
int lidar::native_handle() const noexcept { return driver_->native_handle(); }
std::int64_t lidar::next_deadline_ns() const noexcept { return driver_->next_deadline_ns(); }
result<void> lidar::process() { return driver_->process(); }
void lidar::wake() noexcept { driver_->wake(); }
result<answer> lidar::ask(const request& wanted, while_scanning how) {
  return driver_->ask(wanted, how);
}
const device_information& lidar::information() const noexcept { return driver_->information(); }
std::string_view lidar::name() const noexcept { return driver_->name(); }
bool lidar::is_scanning() const noexcept { return driver_->is_scanning(); }
lidar_counts lidar::counts() const noexcept { return driver_->counts(); }
std::optional<lidar_event> lidar::next_event() noexcept { return driver_->next_event(); }

}  // namespace g4lidar
