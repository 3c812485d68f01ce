// SPDX-License-Identifier: MIT
// The state machine of a session. session.hpp has its contract and the table of its states.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/session/command_channel.hpp"
#include "g4lidar/core/session/request_retry.hpp"
#include "g4lidar/core/session/scan_supervisor.hpp"
#include "g4lidar/core/session_times.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace g4lidar {

/// The state of a session. *Single thread.*
class session_machine {
 public:
  explicit constexpr session_machine(const session_times& times) noexcept : channel_(times) {}

  [[nodiscard]] constexpr std::optional<refusal> begin(
      const request& wanted, std::int64_t now_ns,
      while_scanning how = while_scanning::refuse) noexcept {
    if (!is_possible(wanted)) return refusal::bad_setting;
    if (is_busy()) return refusal::busy;
    const bool disturbs = wanted.what != request_kind::start && wanted.what != request_kind::stop;
    if (scanning_ && disturbs && how == while_scanning::refuse) return refusal::scanning;
    take_up(wanted, now_ns);
    if (wanted.what == request_kind::start && scanning_) {
      if (channel_.is_at_rest()) publish();
      return std::nullopt;  // otherwise it is being started already
    }
    resume_ = scanning_ && disturbs ? resume::later : resume::no;
    surprise_ = !scanning_ && !channel_.is_draining();
    scanning_ = false;
    if (wanted.what != request_kind::stop && is_idle_) {
      go(now_ns);
    } else if (wanted.what == request_kind::stop || !channel_.is_draining()) {
      drain(now_ns);
    }
    return std::nullopt;
  }
  constexpr void take(const event& found, std::int64_t now_ns) noexcept {
    if (has_request_) count(found);
    const bool was_at_rest = channel_.is_at_rest();
    const channel_state now = channel_.take(found, now_ns);
    if (now == channel_state::answered) {
      return on_answer(*std::get_if<response_view>(&found), now_ns);
    }
    on_talk(now, now_ns);
    if (std::get_if<packet_view>(&found) != nullptr) on_packet(was_at_rest, now_ns);
    const auto* const heard = std::get_if<response_view>(&found);
    if (heard != nullptr && was_at_rest && scanning_) on_response_in_scan(*heard, now_ns);
  }
  constexpr void look(std::int64_t now_ns) noexcept {
    if (!channel_.is_at_rest()) return on_talk(channel_.look(now_ns), now_ns);
    if (scanning_) on_need(watch_.look(now_ns, channel_.times()), now_ns);
  }
  [[nodiscard]] constexpr std::int64_t next_look_ns() const noexcept {
    if (scanning_ && channel_.is_at_rest()) return watch_.next_look_ns(channel_.times());
    return channel_.next_look_ns();
  }
  [[nodiscard]] constexpr std::optional<std::array<std::uint8_t, 2>> to_send() noexcept {
    return channel_.to_send();
  }
  [[nodiscard]] constexpr std::optional<outcome> finished() noexcept {
    if (!std::exchange(is_done_, false)) return std::nullopt;
    return outcome_;
  }
  [[nodiscard]] constexpr notice noticed() noexcept { return std::exchange(notice_, notice::none); }
  [[nodiscard]] constexpr bool is_busy() const noexcept { return has_request_ || is_done_; }
  [[nodiscard]] constexpr bool has_nothing() const noexcept {
    return !is_done_ && notice_ == notice::none && !channel_.is_unsent();
  }
  [[nodiscard]] constexpr bool is_scanning() const noexcept { return scanning_; }
  [[nodiscard]] constexpr std::int64_t scan_length_ns() const noexcept {
    return watch_.length_ns();
  }
  [[nodiscard]] constexpr std::optional<power_down_protection> protection() const noexcept {
    return watch_.protection();
  }
  [[nodiscard]] constexpr std::uint64_t retries() const noexcept { return retries_; }
  constexpr void reset() noexcept {
    const std::uint64_t retries = retries_;
    *this = session_machine(channel_.times());
    retries_ = retries;
  }

 private:
  enum class resume : std::uint8_t { no, later, now };
  static constexpr int max_starts = 3;        // then the device is reported as not starting
  static constexpr int max_disturbances = 3;  // of one request, by packets

  // ---- the course of a request ----
  constexpr void take_up(const request& wanted, std::int64_t now_ns) noexcept {
    outcome_ = outcome{};
    outcome_.asked = wanted;
    steps_ = request_retry(wanted);
    has_request_ = true;
    is_broken_ = false;
    disturbances_ = starts_ = 0;
    limit_ns_ = now_ns + channel_.times().request_ns;
    watch_.forget_restarts();
    channel_.question().be_quick();
  }

  constexpr void drain(std::int64_t now_ns) noexcept {
    is_idle_ = false;
    channel_.drain(now_ns);
  }

  /// The device is idle and silent: begins the request.
  constexpr void go(std::int64_t now_ns) noexcept {
    switch (outcome_.asked.what) {
      case request_kind::stop:
        return publish();
      case request_kind::start:
        return start(now_ns);
      case request_kind::restart:
        watch_.set_protection({});
        return channel_.restart(now_ns);
      default:
        return follow(steps_.first(), now_ns);
    }
  }

  constexpr void follow(const request_step& next, std::int64_t now_ns) noexcept {
    switch (next.what) {
      case request_step::action::ask:
        return channel_.ask(next.code, next.has_one_answer, now_ns);
      case request_step::action::doubt:
        count_wrong();
        return channel_.clear(now_ns);
      case request_step::action::end:
        return end(next.how, next.value, now_ns);
      case request_step::action::give_up:
        return end(verdict::timed_out, {}, now_ns);
    }
  }

  constexpr void end(verdict how, const answer& value, std::int64_t now_ns) noexcept {
    outcome_.how = how;
    outcome_.value = value;
    if (how == verdict::timed_out) {
      is_idle_ = false;
      channel_.question().doubt_all();
    }
    if (resume_ != resume::later) return publish();
    resume_ = resume::now;
    starts_ = 0;
    is_idle_ ? start(now_ns) : drain(now_ns);
  }

  constexpr void publish() noexcept {
    channel_.rest();
    resume_ = resume::no;
    has_request_ = false;
    is_done_ = true;
  }

  // ---- the results of operations ----
  constexpr void on_talk(channel_state now, std::int64_t now_ns) noexcept {
    switch (now) {
      case channel_state::going_on:
      case channel_state::answered:
        return;
      case channel_state::quiet:
        return on_quiet(now_ns);
      case channel_state::streaming:
        return on_unstoppable(now_ns);
      case channel_state::wrong:
        return count_wrong();
      case channel_state::lost:
        return on_lost(now_ns);
      case channel_state::silent:
        forget_toggle();
        return end(verdict::timed_out, {}, now_ns);
      case channel_state::disturbed:
        return on_disturbed(now_ns);
      case channel_state::running:
        return on_running(now_ns);
      case channel_state::not_started:
        return starts_ == max_starts ? on_start_failed(now_ns) : drain(now_ns);
      case channel_state::restarted:
        return end(verdict::answered, {}, now_ns);
    }
  }

  constexpr void on_quiet(std::int64_t now_ns) noexcept {
    is_idle_ = true;
    is_runaway_ = false;
    if (wants_start()) return start(now_ns);
    if (!has_request_) return channel_.rest();
    if (!std::exchange(is_broken_, false) || outcome_.asked.what == request_kind::restart) {
      return go(now_ns);
    }
    channel_.clear(now_ns);
  }

  /// Most likely, nothing that is sent arrives. A wanted scan continues.
  constexpr void on_unstoppable(std::int64_t now_ns) noexcept {
    if (resume_ == resume::later) outcome_.how = verdict::still_scanning;
    if (scanning_ || resume_ != resume::no) return on_running(now_ns);
    is_runaway_ = true;
    if (has_request_) return end(verdict::still_scanning, {}, now_ns);
    channel_.rest();
  }

  constexpr void on_answer(const response_view& heard, std::int64_t now_ns) noexcept {
    const auto byte = heard.as_byte();
    if (byte && channel_.question().code() == command::protection_toggle) {
      watch_.set_protection(reply_byte<power_down_protection>(*byte));
    }
    follow(steps_.answered(heard), now_ns);
  }

  constexpr void on_lost(std::int64_t now_ns) noexcept {
    forget_toggle();
    if (now_ns >= limit_ns_) return end(verdict::timed_out, {}, now_ns);
    const request_step next = steps_.lost();
    if (next.what == request_step::action::ask) {
      ++retries_;
      if (outcome_.retries < 0xFF) ++outcome_.retries;
    }
    follow(next, now_ns);
  }

  constexpr void on_disturbed(std::int64_t now_ns) noexcept {
    if (++disturbances_ > max_disturbances) {
      is_runaway_ = true;
      is_idle_ = false;
      channel_.question().doubt_all();
      forget_toggle();
      return end(verdict::still_scanning, {}, now_ns);
    }
    is_broken_ = true;
    drain(now_ns);
  }

  constexpr void forget_toggle() noexcept {
    if (channel_.question().code() == command::protection_toggle) watch_.set_protection({});
  }

  // ---- scanning ----
  [[nodiscard]] constexpr bool wants_start() const noexcept {
    if (!has_request_) return scanning_;
    return resume_ == resume::now || outcome_.asked.what == request_kind::start;
  }

  constexpr void start(std::int64_t now_ns) noexcept {
    ++starts_;
    if (has_request_) outcome_.starts = starts_;
    is_idle_ = false;
    watch_.start_sent(now_ns);
    channel_.start(now_ns);
  }

  constexpr void on_running(std::int64_t now_ns) noexcept {
    channel_.rest();
    scanning_ = true;
    watch_.runs(now_ns);
    if (!has_request_ && starts_ > 1) notice_ = notice::restarted;
    if (has_request_) publish();
  }

  /// A device that restarted is started again by a keep-alive, and has lost its settings.
  constexpr void on_response_in_scan(const response_view& heard, std::int64_t now_ns) noexcept {
    if (heard.kind() != response_kind::scan_started) return;
    on_need(watch_.header(now_ns, channel_.times()), now_ns);
  }

  constexpr void on_start_failed(std::int64_t now_ns) noexcept {
    scanning_ = is_idle_ = false;
    channel_.rest();
    channel_.send_stop();  // it may have received the command without an answer
    channel_.question().doubt_all();
    if (has_request_ && resume_ == resume::no) return end(verdict::timed_out, {}, now_ns);
    notice_ = notice::stalled;
    if (has_request_) publish();
  }

  constexpr void on_need(scan_need need, std::int64_t now_ns) noexcept {
    if (need == scan_need::nothing) return;
    if (need == scan_need::keep_alive) {
      watch_.start_sent(now_ns);
      return channel_.send(command::start);
    }
    notice_ = notice_of(need);
    if (need == scan_need::spinning_up) return;
    starts_ = 0;
    if (need == scan_need::starved) return start(now_ns);
    if (need == scan_need::give_up) scanning_ = false;
    surprise_ = false;
    drain(now_ns);
  }

  /// A packet: of a wanted scan, or of a scan that is reported once and stopped.
  constexpr void on_packet(bool was_at_rest, std::int64_t now_ns) noexcept {
    if (scanning_) return watch_.packet(now_ns);
    if (channel_.is_draining() && std::exchange(surprise_, false)) notice_ = notice::found_scanning;
    if (!was_at_rest || is_runaway_) return;
    notice_ = notice::found_scanning;
    surprise_ = false;
    drain(now_ns);
  }

  constexpr void count(const event& found) noexcept {
    heard_from_device& heard = outcome_.heard;
    if (const auto* noise = std::get_if<skipped>(&found)) {
      heard.skipped_bytes += static_cast<std::uint32_t>(noise->count);
    } else if (std::get_if<time_packet_view>(&found) == nullptr) {
      ++(std::get_if<packet_view>(&found) != nullptr ? heard.packets : heard.responses);
    }
  }
  constexpr void count_wrong() noexcept {
    if (outcome_.wrong_answers < 0xFF) ++outcome_.wrong_answers;
  }

 public:
  // ---- the state; public for tests that compare and change it ----
  command_channel channel_;
  scan_supervisor watch_;
  request_retry steps_;
  outcome outcome_{request{request_kind::device_info}};
  notice notice_ = notice::none;
  resume resume_ = resume::no;  // of the scan that the request has interrupted
  bool has_request_ = false;
  bool is_done_ = false;     // its outcome has not been taken
  bool scanning_ = false;    // the device should scan
  bool is_idle_ = false;     // no bytes arrived after a stop, and no start was sent since
  bool is_runaway_ = false;  // it scans and does not stop
  bool surprise_ = false;    // a packet while draining would belong to an unwanted scan
  bool is_broken_ = false;   // packets arrived instead of an answer
  std::uint8_t disturbances_ = 0;
  std::uint8_t starts_ = 0;  // start commands without a scan
  std::int64_t limit_ns_ = 0;
  std::uint64_t retries_ = 0;
};

}  // namespace g4lidar
