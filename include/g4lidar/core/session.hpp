// SPDX-License-Identifier: MIT
// The command/response session: what to send, when to call again, and the outcome of a request.
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
#include "g4lidar/core/session/request_course.hpp"
#include "g4lidar/core/session/scan_supervisor.hpp"
#include "g4lidar/core/session_times.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// Commands and their answers over a connection that loses, delays and repeats bytes. *Single
/// thread*; has no clock and does no I/O. The caller passes all events of the parser and the time,
/// sends the commands that the session returns, and calls look() at the time that it returns. When
/// nothing has arrived for a while, call stream_parser::finish() before look(): a stopped stream
/// leaves half a packet in the parser, which would swallow an answer.
///
///     state     sent     ends by                        next state
///     --------  -------  -----------------------------  ------------------------------------------
///     rest      (60)     a packet, no scan wanted       draining
///                        no packets of a wanted scan    draining, then starting
///                        a keep-alive that is too late  starting
///     draining  00 65    silence                        rest, starting, asking or booting, by its
///                                                       purpose; clearing if a packet interrupted asking
///                        no silence after all tries     the end: still scanning
///     asking    a        a possible answer              asking the next command, or the end
///               command  an impossible one, none        clearing
///                        a packet                       draining, then clearing
///     clearing  90 (91)  its answer; everything before  asking: again what may be repeated, else
///                        it is discarded                a query of the state that it changes
///                        no answer after all tries      the end: timed out
///     starting  60       the scan header or a packet    rest, scanning; the end
///                        neither                        draining, then starting; or the end
///     booting   80 (40)  silence after the boot text,   probing
///                        or no bytes
///     probing   90       its answer, or none in time    the end
///
/// The end is rest with an outcome, or starting if a scan is to be resumed. Every state except rest
/// has a deadline, and every cycle in the table is counted, so each request ends.
/// (protocol: Commands; The stream)
class session {
 public:
  /// In the state rest; nothing is known about the device but that it is like `model`, which must be
  /// valid as long as the session.
  explicit constexpr session(const session_times& times = session_times(),
                             const model& model = g4_model) noexcept
      : which_(&model), channel_(times) {}

  /// Begins a request, or returns why it is refused. The first request after the connection was
  /// opened stops the device, which may be scanning.
  [[nodiscard]] constexpr std::optional<refusal> begin(
      const request& wanted, std::int64_t now_ns,
      while_scanning if_scanning = while_scanning::refuse) noexcept {
    if (!has_request(*which_, wanted.what)) return refusal::not_supported;
    if (!is_possible(wanted, *which_)) return refusal::bad_setting;
    if (is_busy()) return refusal::busy;
    const bool disturbs = wanted.what != request_kind::start && wanted.what != request_kind::stop;
    if (scanning_ && disturbs && if_scanning == while_scanning::refuse) return refusal::scanning;
    request_.begin(wanted, detail::saturating_add(now_ns, channel_.times().request_ns), *which_);
    starts_ = 0;
    watch_.forget_restarts();
    channel_.question().be_quick();
    if (wanted.what == request_kind::start && scanning_) {
      if (channel_.is_at_rest()) publish();
      return std::nullopt;  // otherwise it is being started already
    }
    resume_ = scanning_ && disturbs ? resume::later : resume::no;
    surprise_ = !scanning_ && !channel_.is_draining();
    scanning_ = false;
    if (wanted.what != request_kind::stop && is_idle_) {
      follow(request_.first(), now_ns);
    } else if (wanted.what == request_kind::stop || !channel_.is_draining()) {
      drain(now_ns);
    }
    return std::nullopt;
  }

  /// Passes an event of the parser and its arrival time. Pass every event, also skipped bytes.
  constexpr void take(const event& found, std::int64_t now_ns) noexcept {
    request_.count(found);
    const bool was_at_rest = channel_.is_at_rest();
    const channel_state now = channel_.take(found, now_ns);
    const auto* const heard = std::get_if<response_view>(&found);
    if (now == channel_state::answered) {
      watch_.answered(channel_.question().code(), *heard);
      return follow(request_.answered(*heard), now_ns);
    }
    if (now != channel_state::going_on) on_talk(now, now_ns);  // not usual
    if (std::get_if<packet_view>(&found) != nullptr) {
      if (scanning_) return watch_.packet(now_ns);
      // Of a scan that is not wanted: it is reported once, and stopped.
      const bool is_found = channel_.is_draining() && std::exchange(surprise_, false);
      if (is_found) notice_ = notice::found_scanning;
      if (!was_at_rest || is_runaway_) return;
      notice_ = notice::found_scanning;
      surprise_ = false;
      return drain(now_ns);
    }
    // A device that restarted is started again by a keep-alive, and has lost its settings.
    if (heard != nullptr && heard->kind() == response_kind::scan_started && was_at_rest &&
        scanning_)
      on_need(watch_.header(now_ns, channel_.times()), now_ns);
  }

  /// Passes the time: call it when next_look_ns() has been reached, after the earlier events.
  constexpr void look(std::int64_t now_ns) noexcept {
    if (!channel_.is_at_rest()) return on_talk(channel_.look(now_ns), now_ns);
    if (scanning_) on_need(watch_.look(now_ns, channel_.times()), now_ns);
  }

  /// When to call look() even if nothing arrives; the largest number if nothing is awaited.
  [[nodiscard]] constexpr std::int64_t next_look_ns() const noexcept {
    if (scanning_ && channel_.is_at_rest()) return watch_.next_look_ns(channel_.times());
    return channel_.next_look_ns();
  }

  /// The next command to send, each once. Call it until it returns nothing, after every other call,
  /// or after all events of one read: none of these events is then taken for an answer to the
  /// command.
  [[nodiscard]] constexpr std::optional<std::array<std::uint8_t, 2>> to_send() noexcept {
    return channel_.to_send();
  }

  /// The outcome of the request, once, when it has ended.
  [[nodiscard]] constexpr std::optional<outcome> finished() noexcept { return request_.finished(); }

  /// The next event to report, each once.
  [[nodiscard]] constexpr notice noticed() noexcept { return std::exchange(notice_, notice::none); }

  /// Whether a request is in progress or its outcome has not been taken.
  [[nodiscard]] constexpr bool is_busy() const noexcept {
    return request_.is_running() || request_.is_done();
  }

  /// Whether to_send(), finished() and noticed() all return nothing.
  [[nodiscard]] constexpr bool has_nothing() const noexcept {
    return !request_.is_done() && notice_ == notice::none && !channel_.is_unsent();
  }

  /// Whether the device scans because of a start request, or a scan is being resumed.
  [[nodiscard]] constexpr bool is_scanning() const noexcept { return scanning_; }

  /// For how long packets arrived, of the running or the last scan; 0 if none has arrived.
  [[nodiscard]] constexpr std::int64_t scan_length_ns() const noexcept {
    return watch_.length_ns();
  }

  /// The state of the power-down protection, if it is known.
  [[nodiscard]] constexpr std::optional<power_down_protection> protection() const noexcept {
    return watch_.protection();
  }

  /// Commands that were repeated because no valid answer arrived.
  [[nodiscard]] constexpr std::uint64_t retries() const noexcept { return request_.retries(); }

  /// The connection was opened again: nothing is known about the device, and no request is in
  /// progress. `model`, if it is not null, is what it is like from now on; valid as long as the session. With `goes_on`
  /// that is all that changes.
  constexpr void reset(const model* model = nullptr, bool goes_on = false) noexcept {
    if (model != nullptr) which_ = model;
    if (goes_on) return;
    request_course request = request_;
    request.reset();
    *this = session(channel_.times(), *which_);
    request_ = request;
  }

 private:
  friend struct session_test_access;
  enum class resume : std::uint8_t { no, later, now };
  static constexpr int max_starts = 3;  // then the device is reported as not starting

  // ---- the course of a request ----
  constexpr void drain(std::int64_t now_ns) noexcept {
    is_idle_ = false;
    channel_.drain(now_ns);
  }

  constexpr void follow(const request_step& next, std::int64_t now_ns) noexcept {
    switch (next.what) {
      case request_step::action::ask:
        return channel_.ask(next.code, next.has_one_answer, now_ns);
      case request_step::action::doubt:
        request_.count_wrong();
        return channel_.clear(now_ns);
      case request_step::action::start:
        return start(now_ns);
      case request_step::action::restart:
        watch_.set_protection({});
        return channel_.restart(now_ns);
      case request_step::action::end:
        return end(next.how, next.value, now_ns);
      case request_step::action::give_up:
        return end(verdict::timed_out, {}, now_ns);
    }
  }

  constexpr void end(verdict decision, const answer& value, std::int64_t now_ns) noexcept {
    request_.decide(decision, value);
    if (decision == verdict::timed_out) {
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
    request_.end();
  }

  // ---- the results of operations ----
  constexpr void on_talk(channel_state now, std::int64_t now_ns) noexcept {
    const bool is_failed = now == channel_state::lost || now == channel_state::silent;
    if (is_failed) watch_.unanswered(channel_.question().code());
    switch (now) {
      case channel_state::going_on:
      case channel_state::answered:
        return;
      case channel_state::quiet:
        return on_quiet(now_ns);
      case channel_state::streaming:
        if (resume_ == resume::later) request_.decide(verdict::still_scanning, {});
        // Most likely, nothing that is sent arrives. A wanted scan continues.
        if (scanning_ || resume_ != resume::no) return on_running(now_ns);
        return on_runaway(now_ns);
      case channel_state::wrong:
        return request_.count_wrong();
      case channel_state::lost:
        return follow(request_.lost(now_ns), now_ns);
      case channel_state::silent:
        return end(verdict::timed_out, {}, now_ns);
      case channel_state::disturbed:
        if (request_.disturbed()) return drain(now_ns);
        is_idle_ = false;
        channel_.question().doubt_all();
        watch_.unanswered(channel_.question().code());
        return on_runaway(now_ns);
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
    if (!request_.is_running()) return scanning_ ? start(now_ns) : channel_.rest();
    const request_kind kind = request_.kind();
    if (resume_ == resume::now || kind == request_kind::start) return start(now_ns);
    if (request_.take_broken() && kind != request_kind::restart) return channel_.clear(now_ns);
    follow(request_.first(), now_ns);
  }

  /// Packets arrive, whatever is sent.
  constexpr void on_runaway(std::int64_t now_ns) noexcept {
    is_runaway_ = true;
    if (request_.is_running()) return end(verdict::still_scanning, {}, now_ns);
    channel_.rest();
  }

  // ---- scanning ----
  constexpr void start(std::int64_t now_ns) noexcept {
    request_.count_starts(++starts_);
    is_idle_ = false;
    watch_.start_sent(now_ns);
    channel_.start(now_ns);
  }

  constexpr void on_running(std::int64_t now_ns) noexcept {
    channel_.rest();
    scanning_ = true;
    watch_.runs(now_ns);
    if (request_.is_running()) return publish();
    if (starts_ > 1) notice_ = notice::restarted;
  }

  constexpr void on_start_failed(std::int64_t now_ns) noexcept {
    scanning_ = is_idle_ = false;
    channel_.rest();
    channel_.send_stop();  // it may have received the command without an answer
    channel_.question().doubt_all();
    const bool is_asked = request_.is_running();
    if (is_asked && resume_ == resume::no) return end(verdict::timed_out, {}, now_ns);
    notice_ = notice::stalled;
    if (is_asked) publish();
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

  const model* which_;
  command_channel channel_;
  scan_supervisor watch_;
  request_course request_;
  notice notice_ = notice::none;
  resume resume_ = resume::no;  // of the scan that the request has interrupted
  bool scanning_ = false;       // the device should scan
  bool is_idle_ = false;        // no bytes arrived after a stop, and no start was sent since
  bool is_runaway_ = false;     // it scans and does not stop
  bool surprise_ = false;       // a packet while draining would belong to an unwanted scan
  std::uint8_t starts_ = 0;     // start commands without a scan
};

}  // namespace g4lidar
