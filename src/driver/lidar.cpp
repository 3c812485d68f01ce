// SPDX-License-Identifier: MIT
// The public interface of the driver.
#include "g4lidar/lidar.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "core/enumerators.hpp"
#include "core/number_text.hpp"
#include "driver.hpp"
#include "g4lidar/core/model_choice.hpp"
#include "g4lidar/transport/source.hpp"
#include "option_problems.hpp"
#include "outcome_error.hpp"
#include "transport/tcp_port.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;

}  // namespace

std::string model_words() { return list_of(models, &model::word); }
std::string why_no_model(std::string_view label) {
  const std::string given = in_quotes(label);
  if (const auto why = why_unsupported(label); !why.empty())
    return (given + " is not supported: ").append(why);
  return given + " is not one of " + model_words();
}
std::string model_words(std::span<const model* const> which) {
  return list_of(which, [](const model* each) { return each->word; });
}

std::string_view name_of(lidar_event::kind what) noexcept {
  constexpr std::array<std::string_view, 14> names{
      "lost",        "reconnected",   "found_scanning", "protection_starved", "protection_found_on",
      "spinning_up", "restarted",     "health_warning", "other_lidar",        "long_pause",
      "overflow",    "still_turning", "no_zero_angle",  "other_number"};
  return detail::name_in(names, what);
}

lidar::lidar(std::unique_ptr<driver> made) noexcept : driver_(std::move(made)) {}
lidar::lidar(lidar&&) noexcept = default;
lidar& lidar::operator=(lidar&&) noexcept = default;
lidar::~lidar() = default;

namespace {

/// Waits until the next attempt to open; false if that is cancelled.
bool waited(const lidar_options& options) {
  constexpr int parts = 10;
  for (int i = 0; i < parts; ++i) {
    if (options.is_cancelled && options.is_cancelled()) return false;
    std::this_thread::sleep_for(50ms);
  }
  return true;
}

/// Whether the lidar may have another rate than its model: what sends there is not the named model at its rate; or it
/// sends, and answers nothing; or nothing is heard at this rate, and the rate can be changed.
bool may_be_at_another_rate(const error& why, const lidar_options& options) {
  const source_kind kind = kind_of_source(options.device);
  if (kind != source_kind::device && kind != source_kind::simulated) return false;
  if (why == problem::does_not_stop) return true;
  if (options.baud != 0) return false;
  if (why == problem::garbage) return true;
  // A lidar that sends would have been heard; with several rates it was searched before.
  const bool has_bridge = is_bridge(path_of_source(options.device));
  const model* const named = model_of_source(options).value_or(nullptr);
  const bool waits = named != nullptr && named->link == link_kind::two_way && named->bauds[1] == 0;
  return why == problem::silence && waits && !options.listen_only && !has_bridge;
}

}  // namespace

result<lidar> lidar::open(const lidar_options& options) {
  const auto begin = std::chrono::steady_clock::now();
  lidar_options used = options;  // without what is for opening alone
  used.wrap = nullptr;
  used.is_cancelled = nullptr;
  while (true) {
    const auto open_at = [&](bool at_any_rate) {
      auto from = connector_for(options, at_any_rate);
      if (from && options.wrap) from = options.wrap(*std::move(from));
      return from ? open(*std::move(from), used) : tl::unexpected(from.error());
    };
    auto opened = open_at(false);
    if (!opened && may_be_at_another_rate(opened.error(), options)) opened = open_at(true);
    const auto waited_for = std::chrono::steady_clock::now() - begin;
    const bool is_late =
        std::chrono::duration_cast<milliseconds>(waited_for) >= options.device_wait;
    if (opened || is_late || !opened.error().may_pass()) return opened;
    if (!waited(options)) return failure(task::opening, problem::cancelled, options.device);
  }
}

result<lidar> lidar::open(std::string_view device, const lidar_options& options) {
  lidar_options named = options;
  named.device = device;
  return open(named);
}

result<lidar> lidar::open(std::unique_ptr<connector> connector, const lidar_options& options) {
  const connector_traits behind = connector->traits();
  const model* const stated = behind.recognised.model;
  if (const auto wrong = problem_with_model(options, behind.recognised, "the source")) {
    return tl::unexpected(*wrong);
  }
  lidar_options used = options;
  const bool follows = used.model == nullptr && behind.begun_as != nullptr;
  if (used.model == nullptr) used.model = follows ? behind.begun_as : stated;
  if (behind.recognised.is_silent && behind.answers) used.listen_only = true;
  if (used.model == nullptr) used.model = &g4_model;
  using namespace option_user;
  const option_users users = behind.answers ? live | port : recording | raw_file | pipe;
  if (const auto wrong = problem_with_users(used, users)) return tl::unexpected(*wrong);
  // Where the port could not be opened, there is no model that could refuse a setting.
  const bool is_missing = behind.is_searched && stated == nullptr;
  if (const auto wrong = problem_with_use(used)) return tl::unexpected(*wrong);
  if (const auto wrong = problem_with_settings(used); wrong && !is_missing) {
    return tl::unexpected(with_candidates(*wrong, behind.recognised.candidates));
  }
  g4lidar::recognition known = behind.recognised;
  if (options.model != nullptr && (stated == nullptr || *stated != *options.model)) {
    known.by = known_by::user;
    known.candidates = {};
  } else if (follows) {
    known.by = used.model->has_number(known.number) ? known_by::number : known_by::nothing;
    known.candidates = {};
  }
  auto made = std::make_unique<driver>(std::move(connector), used, known);
  if (auto opened = made->open(); !opened) return tl::unexpected(opened.error());
  return lidar(std::move(made));
}

result<void> lidar::start() { return driver_ ? driver_->start() : moved_from(); }
result<void> lidar::stop() { return driver_ ? driver_->stop() : moved_from(); }
result<void> lidar::close() { return driver_ ? driver_->close() : result<void>(); }
void lidar::release() noexcept {
  if (driver_) driver_->release();
}
g4lidar::recognition lidar::recognition() const noexcept {
  static constexpr const model* none[] = {&g4_model};
  if (driver_) return driver_->recognition();
  return {.model = &g4_model, .candidates = none};
}
lidar_event_loop lidar::event_loop() & noexcept { return lidar_event_loop(*this); }
milliseconds lidar_event_loop::scan_due_in() const noexcept {
  if (!of_->driver_) return 0ms;
  const scan_source& source = of_->driver_->source();
  return time_until(source, source.expects().not_due_before_ns);
}
view_result<std::span<const point>> lidar::next_points(milliseconds timeout) {
  if (!driver_) return moved_from();
  return driver_->next_points(timeout);
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
result<answer> lidar::ask(const request& wanted, while_scanning if_scanning) {
  if (!driver_) return moved_from();
  if (if_scanning > while_scanning::stop_and_resume) {
    return failure(task::asking, problem::bad_option, "how: refuse or stop_and_resume");
  }
  if (wanted.what > g4lidar::request_kind::stop) {
    return failure(task::asking, problem::bad_option, "a request that namespace requests has");
  }
  return driver_->ask(wanted, if_scanning);
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
