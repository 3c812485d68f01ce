// SPDX-License-Identifier: MIT
// The public interface of the driver.
#include "g4lidar/lidar.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <thread>
#include <utility>

#include "driver.hpp"
#include "error_context.hpp"
#include "g4lidar/core/session/model_requests.hpp"
#include "g4lidar/source.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;

/// Limited so that its sum with a time of the clock does not overflow.
std::int64_t in_ns(milliseconds time) noexcept {
  constexpr milliseconds longest = std::chrono::hours(24 * 365);
  return std::chrono::nanoseconds(std::clamp(time, milliseconds(0), longest)).count();
}

error bad(std::string_view what) noexcept { return {task::configuring, problem::bad_option, what}; }

/// "OPTION: LEAST to MOST, not GIVEN UNIT".
error bad(std::string_view what, std::int64_t given, std::string_view unit) noexcept {
  error_context words(what);
  words.add(given < 0 ? ", not -" : ", not ");
  constexpr std::int64_t most = UINT32_MAX;
  const std::int64_t size = std::clamp(given, -most, most);
  return bad(words.add(static_cast<std::uint32_t>(size < 0 ? -size : size)).add(unit));
}

/// "sample_rate: 8000, 16000 or 18000 of a G6".
error bad_rate(const model& which) noexcept {
  error_context words("sample_rate: ");
  const std::uint8_t count = rate_count(which);
  for (std::uint8_t code = 0; code < count; ++code) {
    const std::string_view before = code == 0 ? "" : code + 1 == count ? " or " : ", ";
    words.add(before).add(rate_hz_of_code(which, code));
  }
  return bad(words.add(" of a ").add(which.name));
}

/// "frequency: 500 to 1200 (5 to 12 Hz of a G4), not 1300".
error bad_frequency(const model& which, scan_frequency given) noexcept {
  const auto [least_dhz, most_dhz, reply, ct] = which.frequency;
  error_context words("frequency: ");
  words.add(least_dhz * 10U).add(" to ").add(most_dhz * 10U).add(" (").add(least_dhz / 10U);
  words.add(" to ").add(most_dhz / 10U).add(" Hz of a ").add(which.name).add(")");
  return bad(words, given.chz, "");
}

/// Of the settings that `options` give.
std::optional<error> problem_with_settings(const lidar_options& options) noexcept {
  const model& which = options.model != nullptr ? *options.model : g4_model;
  const auto problem_of = [&](const auto& setting, std::string_view name,
                              const error& bad_value) -> std::optional<error> {
    if (!setting) return std::nullopt;
    const request change = requests::set(*setting);
    if (!has_request(which, change.what)) {
      return error(task::configuring, problem::not_supported,
                   error_context(name).add(", ").add(which.name));
    }
    return is_possible(change, which) ? std::nullopt : std::optional(bad_value);
  };
  std::optional<error> found = problem_of(options.sample_rate, "sample_rate", bad_rate(which));
  if (!found && options.frequency) {
    found = problem_of(options.frequency, "frequency", bad_frequency(which, *options.frequency));
  }
  if (!found) {
    found = problem_of(options.direction, "direction",
                       bad("direction: clockwise or counter_clockwise"));
  }
  if (!found) found = problem_of(options.constant, "constant", bad("constant: on or off"));
  if (!found) found = problem_of(options.idle, "idle", bad("idle: on or off"));
  if (!found) found = problem_of(options.protection, "protection", bad("protection: on or off"));
  return found;
}

}  // namespace

std::optional<error> problem_with(const lidar_options& options) noexcept {
  const auto within = [](auto value, auto least, auto most) {
    return value >= least && value <= most;
  };
  if (auto wrong = problem_with_settings(options)) return wrong;
  if (options.tuning.pace > read_pace::revolutions)
    return bad("pace: automatic, packets or revolutions");
  const auto bad_time = [](std::string_view what, milliseconds given) {
    return bad(what, given.count(), " ms");
  };
  if (!within(options.tuning.longest_backoff, 1ms, 1000ms))
    return bad_time("longest_backoff: 1 ms to 1 s", options.tuning.longest_backoff);
  if (!within(options.tuning.answer_time, 10ms, 10'000ms))
    return bad_time("answer_time: 10 ms to 10 s", options.tuning.answer_time);
  if (!within(options.tuning.stall_time, 100ms, 60'000ms))
    return bad_time("stall_time: 100 ms to 1 min", options.tuning.stall_time);
  if (!within(options.tuning.batch, 0ms, 100ms))
    return bad_time("batch: 0 to 100 ms", options.tuning.batch);
  if (!within(options.tuning.transport_delay, 0ns, 1'000'000'000ns)) {
    return bad("transport_delay: 0 to 1 s", options.tuning.transport_delay.count(), " ns");
  }
  if (options.raw_sample_rate_hz && !within(*options.raw_sample_rate_hz, 1U, 1'000'000U)) {
    return bad("raw_sample_rate_hz: 1 to 1000000", *options.raw_sample_rate_hz, "");
  }
  return std::nullopt;
}

std::string model_words() {
  std::string all;
  for (const model& each : models) {
    if (!all.empty()) all += ", ";
    all += each.word;
  }
  return all;
}

std::string_view name_of(lidar_event::kind what) noexcept {
  constexpr std::array<std::string_view, 12> names{
      "lost",        "reconnected",  "found_scanning", "protection_starved", "protection_found_on",
      "spinning_up", "restarted",    "health_warning", "other_lidar",        "long_pause",
      "overflow",    "still_turning"};
  return names[static_cast<std::size_t>(what)];
}

lidar::lidar(std::unique_ptr<driver> made) noexcept : driver_(std::move(made)) {}
lidar::lidar(lidar&&) noexcept = default;
lidar& lidar::operator=(lidar&&) noexcept = default;
lidar::~lidar() = default;

namespace {

/// Whether a device that is plugged in later would be opened.
bool may_come(const error& why) noexcept {
  using enum problem;
  return why == no_port || why == silence || why == gone || why == cannot_connect ||
         why == garbage || why == busy;
}

/// Waits until the next attempt to open; false if that is cancelled.
bool waited(const lidar_options& options) {
  constexpr int parts = 10;
  for (int i = 0; i < parts; ++i) {
    if (options.is_cancelled && options.is_cancelled()) return false;
    std::this_thread::sleep_for(50ms);
  }
  return true;
}

}  // namespace

result<lidar> lidar::open(const lidar_options& options) {
  const auto begin = std::chrono::steady_clock::now();
  lidar_options used = options;  // without what is for opening alone
  used.wrap = nullptr;
  used.is_cancelled = nullptr;
  while (true) {
    auto from = connector_for(options);
    if (from && options.wrap) from = options.wrap(*std::move(from));
    auto opened = from ? open(*std::move(from), used) : tl::unexpected(from.error());
    const auto waited_for = std::chrono::steady_clock::now() - begin;
    const bool is_late =
        std::chrono::duration_cast<milliseconds>(waited_for) >= options.device_wait;
    if (opened || is_late || !may_come(opened.error())) return opened;
    if (!waited(options)) return failure(task::opening, problem::cancelled, options.device);
  }
}

result<lidar> lidar::open(std::string_view device, const lidar_options& options) {
  lidar_options named = options;
  named.device = device;
  return open(named);
}

result<lidar> lidar::open(std::unique_ptr<connector> from, const lidar_options& options) {
  const model* const stated = from->traits().model;
  if (options.model != nullptr && stated != nullptr && options.model->word != stated->word) {
    return failure(task::opening, problem::bad_option,
                   "model: " + std::string(options.model->word) + ", and the source states " +
                       std::string(stated->word));
  }
  lidar_options used = options;
  if (stated != nullptr) used.model = stated;
  if (used.model == nullptr) used.model = &g4_model;
  if (const auto problem = problem_with(used)) return tl::unexpected(*problem);
  auto made = std::make_unique<driver>(std::move(from), used);
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
  return driver_->next_scan(in_ns(timeout), false);
}
view_result<scan> lidar::wait_scan(milliseconds timeout) {
  if (!driver_) return moved_from();
  return driver_->next_scan(in_ns(timeout), true);
}
lidar_event_loop lidar::event_loop() & noexcept { return lidar_event_loop(*this); }
milliseconds lidar_event_loop::scan_due_in() const noexcept {
  const std::int64_t left_ns = of_->driver_ ? of_->driver_->scan_due_in_ns() : 0;
  if (left_ns == never_ns) return milliseconds::max();
  return std::chrono::ceil<milliseconds>(std::chrono::nanoseconds(left_ns));
}
view_result<std::span<const point>> lidar::next_points(milliseconds timeout) {
  if (!driver_) return moved_from();
  return driver_->next_points(in_ns(timeout));
}
const lidar_ring& lidar::points() const noexcept {
  return driver_ ? driver_->points() : empty_ring();
}
int lidar_event_loop::native_handle() const noexcept {
  return of_->driver_ ? of_->driver_->native_handle() : -1;
}
std::int64_t lidar_event_loop::next_deadline_ns() const noexcept {
  return of_->driver_ ? of_->driver_->next_deadline_ns() : never_ns;
}
std::chrono::steady_clock::time_point lidar_event_loop::next_deadline() const noexcept {
  using clock = std::chrono::steady_clock;
  return clock::time_point(std::chrono::nanoseconds(next_deadline_ns()));
}
result<void> lidar_event_loop::process() {
  return of_->driver_ ? of_->driver_->process() : moved_from();
}
void lidar::wake() noexcept {
  if (driver_) driver_->wake();
}
result<answer> lidar::ask(const request& wanted, while_scanning how) {
  if (!driver_) return moved_from();
  if (how > while_scanning::stop_and_resume) {
    return failure(task::asking, problem::bad_option, "how: refuse or stop_and_resume");
  }
  if (wanted.what > g4lidar::request_kind::stop) {
    return failure(task::asking, problem::bad_option, "a request that namespace requests has");
  }
  return driver_->ask(wanted, how);
}
const device_information& lidar::information() const noexcept {
  static constexpr device_information none{};
  return driver_ ? driver_->information() : none;
}
std::optional<device_information> lidar::module_information() const noexcept {
  return driver_ ? driver_->module_information() : std::nullopt;
}
player* lidar::player() noexcept { return driver_ ? driver_->player() : nullptr; }
std::string_view lidar::name() const noexcept { return driver_ ? driver_->name() : "closed"; }
bool lidar::is_scanning() const noexcept { return driver_ && driver_->is_scanning(); }
lidar_counts lidar::counts() const noexcept { return driver_ ? driver_->counts() : lidar_counts(); }
std::optional<lidar_event> lidar::next_event() noexcept {
  return driver_ ? driver_->next_event() : std::nullopt;
}

}  // namespace g4lidar
