// SPDX-License-Identifier: MIT
// The driver's line: connected, awoken, broken off, and connected again.
#include <algorithm>
#include <utility>

#include "driver.hpp"

namespace g4lidar {
namespace {

/// The first pause between attempts, after one without any.
constexpr std::int64_t first_pause_ns = 20'000'000;

}  // namespace

result<void> lidar::driver::connect() {
  auto made = connector_->connect();
  if (!made) return tl::unexpected(made.error());
  static_cast<void>(exchange_line(std::move(*made)));
  ready_.follow(line_->native_handle());
  session_.reset();
  stops_ = false;
  last_bytes_ns_ = read_until_ns_ = now_ns();
  stream_.follow(line_->baud());
  pace_.reset(line_->answers() ? line_->baud() : 0);
  planned_ = plan_at_ = 0;
  stage_ = stage::identifying;
  if (line_->answers()) {
    note(line_note::kind::held);
    plan(requests::device_info(), true);
  } else {
    opened_ = true;
    stage_ = stage::idle;
    begin_replay();
  }
  return {};
}

std::unique_ptr<transport> lidar::driver::exchange_line(std::unique_ptr<transport> made) noexcept {
  while (line_changes_.test_and_set()) {
    // For the moment in which another thread wakes it.
  }
  line_.swap(made);
  line_changes_.clear();
  pass_on_wake();
  return made;
}

void lidar::driver::release_line() noexcept {
  cut_off();  // the line is to know
  ready_.follow(-1);
  exchange_line(nullptr).reset();
  planned_ = plan_at_ = 0;
  setting_up_again_ = false;
}

/// Nobody will see to it any more. It may hear this, even if nothing is heard of it.
void lidar::driver::leave_stopped(const error& why) noexcept {
  if (line_ == nullptr || !line_->answers() || why.what() == problem::gone) return;
  for (const command each : {command::forced_stop, command::stop}) {
    if (!send(encode(each))) return;
  }
}

/// The line has broken, or is of no use. Gives an error if that is the end.
result<void> lidar::driver::hang_up(const error& broken) {
  const bool was_up = stage_ > stage::identifying;
  const bool was_live = line_ == nullptr || line_->answers();
  const error why = spoilt(broken);
  if (was_up) leave_stopped(why);
  release_line();
  if (was_up) {
    tell(lidar_event::kind::lost, why.what());
    backoff_ns_ = 0;
  }
  lost_ = why;
  if (options_.reconnect && opened_ && was_live) {
    stage_ = stage::lost;
    next_attempt_ns_ = now_ns() + backoff_ns_;
    const auto longest = std::chrono::nanoseconds(options_.longest_backoff).count();
    backoff_ns_ = std::min(std::max(2 * backoff_ns_, first_pause_ns), longest);
    return {};
  }
  stream_.end();
  stage_ = stage::closed;
  return tl::unexpected(why);
}

result<void> lidar::driver::wait_for_line(std::int64_t deadline_ns) {
  if (now_ns() < next_attempt_ns_) {
    static_cast<void>(connector_->pause(std::min(deadline_ns, next_attempt_ns_)));
    if (now_ns() < next_attempt_ns_) return {};
  }
  if (auto connected = connect(); !connected) return hang_up(connected.error());
  return serve();
}

void lidar::driver::wake() noexcept {
  woken_.store(true);
  to_kick_.store(true);
  pass_on_wake();
}

/// Ends the wait of whoever waits. Whoever finds the line held leaves this to the holder, who comes
/// here behind it: in a signal handler there is nothing to wait for.
void lidar::driver::pass_on_wake() noexcept {
  while (to_kick_.load() && !line_changes_.test_and_set()) {
    if (to_kick_.exchange(false)) line_ != nullptr ? line_->wake() : connector_->wake();
    line_changes_.clear();
  }
}

}  // namespace g4lidar
