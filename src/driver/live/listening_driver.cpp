// SPDX-License-Identifier: MIT
#include "listening_driver.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "driver/error_context.hpp"
#include "driver/outcome_error.hpp"

namespace g4lidar {
namespace {

/// For the first byte, before the line DTR gets a pulse, and for the first packets after it: the motor
/// may be about to spin up.
constexpr std::int64_t listen_ns = 1'000'000'000;
constexpr std::int64_t spin_up_ns = 2'000'000'000;
constexpr std::uint64_t packets_to_recognise = 3;

}  // namespace

// ---- one round ----------------------------------------------------------------------------------

result<void> listening_driver::round(std::int64_t deadline_ns) {
  if (stage_ == live_stage::idle) {
    connection_.pause(deadline_ns);
    return {};
  }
  stream_.follow_delivery();
  if (stream_.parse()) return {};
  if (auto looked = look(); !looked || stage_ == live_stage::idle) return looked;
  if (auto got = stream_.receive(std::min(deadline_ns, due_ns())); !got) return got;
  if (stream_.parse()) return {};
  if (auto same = follow_samples(); !same) return same;
  return look();
}

/// What the bytes that were parsed mean, and whether they came in time.
// NOLINTNEXTLINE(misc-no-recursion): recognised() leaves the stage
result<void> listening_driver::look() {
  identity_reader& reported = stream_.reported();
  if (reported.take_news()) {
    // It may identify itself at any time: after a revolution, and when it gets power.
    // NOLINTNEXTLINE(bugprone-unchecked-optional-access): there is news
    if (auto known = identified(*reported.who()); !known) return known;
    if (reported.has_other_number()) report(lidar_event::kind::other_number);
  }
  if (stage_ == live_stage::identifying && reported.packets() >= packets_to_recognise) {
    return recognised();
  }
  const bool is_moving = stage_ == live_stage::scanning && reported.packets() != packets_;
  if (is_moving) {
    packets_ = reported.packets();
    bytes_before_ = pipeline_.input().bytes_parsed();
    pulse_ = pulse::none;
    due_ns_ =
        receiver_.read_until_ns() + std::chrono::nanoseconds(options_.tuning.stall_time).count();
  }
  // Bytes that arrived while the program was suspended are read before that.
  if (now_ns() < due_ns_ || receiver_.read_until_ns() < due_ns_) return {};
  const bool is_stalled = stage_ == live_stage::scanning;
  const std::uint64_t without_packet = pipeline_.input().bytes_parsed() - bytes_before_;
  const bool is_silent = is_stalled || without_packet == 0;
  const bool may_help = !is_stalled || options_.model->motor == motor_kind::dtr;
  if (pulse_ != pulse::done && may_help) return try_pulse(is_silent);
  constexpr std::uint64_t of_a_packet = 256;
  if (is_stalled && without_packet > of_a_packet) {
    return tl::unexpected(without_packets(connection_, without_packet));
  }
  if (is_stalled) return failure(task::reading, problem::stalled, connection_.name());
  return failure(task::opening, is_silent ? problem::silence : problem::garbage,
                 opened_as(connection_, *options_.model)
                     .add(options_.listen_only ? ", only listened to" : "")
                     .add(stream_.heard().text()));
}

/// Some boards start the motor, or the lidar, at an edge of DTR only.
result<void> listening_driver::try_pulse(bool is_silent) {
  if (pulse_ == pulse::none && is_silent) {
    if (auto lowered = stream_.set_motor(false); !lowered) return lowered;
    pulse_ = pulse::low;
    due_ns_ = stream_.motor_ready_ns();
    if (due_ns_ > now_ns()) return {};
  }
  if (pulse_ == pulse::low) {
    if (auto raised = stream_.set_motor(true); !raised) return raised;
  }
  pulse_ = pulse::done;
  due_ns_ = now_ns() + spin_up_ns;
  return {};
}

// NOLINTNEXTLINE(misc-no-recursion): it leaves the stage, so look() calls it once
result<void> listening_driver::recognised() {
  become_recognised();
  stage_ = live_stage::idle;
  if (reconnection_.end()) report(lidar_event::kind::reconnected);
  if (!wants_scan_) return {};
  stage_ = live_stage::scanning;
  packets_ = 0;
  stream_.follow_delivery();
  return look();
}

std::int64_t listening_driver::due_ns() const noexcept {
  return stage_ == live_stage::idle ? never_ns : std::min(stream_.next_deadline_ns(), due_ns_);
}

result<void> listening_driver::connected() {
  pulse_ = pulse::none;
  due_ns_ = now_ns() + listen_ns;
  bytes_before_ = pipeline_.input().bytes_parsed();
  return stream_.set_motor(true);
}

// ---- requests -----------------------------------------------------------------------------------

/// What arrived while nobody read is older than the start.
result<void> listening_driver::drop_old() {
  constexpr int most_reads = 64;
  for (int i = 0; i < most_reads; ++i) {
    const std::uint64_t before = pipeline_.input().bytes_parsed();
    if (auto got = stream_.receive(now_ns()); !got) return got;
    while (stream_.parse()) pipeline_.drop_scan();
    if (pipeline_.input().bytes_parsed() == before) break;
  }
  return {};
}

result<void> listening_driver::start() {
  if (is_scanning()) return {};
  if (auto ready = settle(); !ready) return ready;
  wants_scan_ = true;
  if (is_scanning()) return {};  // a start that was woken
  pipeline_.drop_scan();
  spin_up_.forget();
  if (auto dropped = drop_old(); !dropped) {
    const auto broken = break_off(dropped.error());
    return broken ? dropped : broken;
  }
  stage_ = live_stage::scanning;
  packets_ = 0;  // some have come: look() sets the time of the next ones
  stream_.follow_delivery();
  return {};
}

result<void> listening_driver::stop() {
  wants_scan_ = false;
  if (stage_ == live_stage::lost) return {};
  if (auto ready = settle(); !ready) return ready;
  pipeline_.drop_scan();
  if (stage_ != live_stage::scanning) return {};
  stream_.flush();
  stage_ = live_stage::idle;
  stream_.follow_delivery();
  pipeline_.end();
  report(lidar_event::kind::still_turning);
  return {};
}

result<answer> listening_driver::ask(const request& wanted, while_scanning /*how*/) {
  if (auto ready = settle(); !ready) return tl::unexpected(ready.error());
  const auto condition = stream_.reported().condition();
  if (wanted.what == request_kind::device_info && information_.is_known()) return information_;
  if (wanted.what == request_kind::health && condition) return *condition;
  if (options_.model->link == link_kind::two_way) {  // which has such a command, or not
    return failure(task::asking, problem::not_supported,
                   error_context(connection_.name()).add(wanted), 0, error_detail::only_listens);
  }
  const error refused = refusal_error(task::asking, refusal::not_supported, wanted, *options_.model,
                                      connection_.name());
  return tl::unexpected(with_candidates(refused, recognised_.get().candidates));
}

}  // namespace g4lidar
