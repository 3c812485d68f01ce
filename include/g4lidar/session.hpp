// SPDX-License-Identifier: MIT
// The command/response session: what to send, when to look again, and what became of a request.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include "g4lidar/command.hpp"
#include "g4lidar/request.hpp"
#include "g4lidar/response.hpp"
#include "g4lidar/scan_watch.hpp"
#include "g4lidar/session_steps.hpp"
#include "g4lidar/stream_parser.hpp"

namespace g4lidar {

/// Commands and their answers over a line that loses, delays and repeats. *Single thread*; knows no
/// clock and does no I/O. The caller shows it all events of the parser and the time, sends what it
/// says, and looks again when it says. When nothing has come for a while, stream_parser::finish()
/// comes before look(): a stopped stream leaves half a packet behind that would swallow an answer.
///
///     phase      sent     ends by                        and then
///     ---------  -------  -----------------------------  ------------------------------------------
///     rest       (60)     a packet, no scan wanted       draining
///                         a wanted scan falls silent     draining, then starting
///                         fed too late                   starting
///     draining   00 65    silence                        what it was for: rest, starting, asking,
///                                                        booting, or clearing if it broke a question
///                         none, told often enough        the end: still scanning
///     asking     a        a possible answer              asking the next, or the end
///                command  an impossible one, none        clearing
///                         a packet                       draining, then clearing
///     clearing   90 (91)  its answer; all before it is   asking: again what may be repeated, else
///                         thrown away                    the state; or the end, booted
///                         no answer, asked often enough  the end: timed out
///     starting   60       the scan header or a packet    rest, scanning; the end
///                         neither                        draining, then starting; or the end
///     booting    80 (40)  silence after boot text, or    clearing
///                         nothing at all
///
/// The end is rest with an outcome, or starting where a scan is to be resumed. Every wait has a
/// deadline, every count a bound, so each request ends. (protocol: Commands; The stream)
class session {
 public:
  explicit constexpr session(const session_times& times = {}) noexcept : times_(times) {}

  /// Begins a request, or says why not. The first after the line was opened stops the device, which
  /// may be scanning. What is to be sent is in to_send().
  [[nodiscard]] constexpr std::optional<refusal> begin(
      const request& wanted, std::int64_t now_ns,
      while_scanning how = while_scanning::refuse) noexcept {
    if (is_busy()) return refusal::busy;
    const bool disturbs = wanted.what != ask::start && wanted.what != ask::stop;
    if (scanning_ && disturbs && how == while_scanning::refuse) return refusal::scanning;
    take_up(wanted, now_ns);
    if (wanted.what == ask::start && scanning_) {
      if (phase_ == phase::rest) publish();
      return std::nullopt;  // otherwise it is being started already
    }
    resume_ = scanning_ && disturbs ? resume::later : resume::no;
    surprise_ = !scanning_ && phase_ != phase::draining;
    scanning_ = false;
    if (wanted.what != ask::stop && is_idle_) {
      go(now_ns);
    } else if (wanted.what == ask::stop || phase_ != phase::draining) {
      drain(now_ns);
    }
    return std::nullopt;
  }

  /// Shows an event of the parser and when its bytes came. Every event, the skipped bytes too.
  constexpr void take(const event& found, std::int64_t now_ns) noexcept {
    heard_ns_ = std::max(heard_ns_, now_ns);
    has_signs_ = true;
    if (has_request_) count(found);
    if (const auto* reply = std::get_if<response_view>(&found)) return on_response(*reply, now_ns);
    if (std::get_if<packet_view>(&found) != nullptr) on_packet(now_ns);
  }

  /// Lets time pass: call it when next_look_ns() has come, after the events from before then.
  constexpr void look(std::int64_t now_ns) noexcept {
    if (phase_ == phase::rest) return look_at_scan(now_ns);
    if (now_ns < next_look_ns()) return;
    switch (phase_) {
      case phase::draining:
        return now_ns >= heard_ns_ + times_.quiet_ns ? on_quiet(now_ns) : on_unquiet(now_ns);
      case phase::asking:
        return clear(now_ns);
      case phase::clearing:
        return on_unclear(now_ns);
      case phase::starting:
        return start_tries_ == max_tries ? on_start_failed(now_ns) : drain(now_ns);
      case phase::booting:
        return on_boot_wait(now_ns);
      case phase::rest:
        break;
    }
  }

  /// When to look again even if nothing comes; the largest number where nothing is awaited.
  [[nodiscard]] constexpr std::int64_t next_look_ns() const noexcept {
    switch (phase_) {
      case phase::rest:
        break;
      case phase::draining:
        return std::min(heard_ns_ + times_.quiet_ns, deadline_ns_);
      case phase::booting:
        if (has_signs_) return std::min(heard_ns_ + 2 * times_.quiet_ns, boot_until_ns_);
        return deadline_ns_;
      default:
        return deadline_ns_;
    }
    return scanning_ ? watch_.next_look_ns(times_) : std::numeric_limits<std::int64_t>::max();
  }

  /// The next command to send, once; call until it gives nothing, after every other call.
  [[nodiscard]] constexpr std::optional<std::array<std::uint8_t, 2>> to_send() noexcept {
    if (sent_ == queued_) return std::nullopt;
    return encode(queue_[sent_++]);
  }

  /// What became of the request, once, when it has ended.
  [[nodiscard]] constexpr std::optional<outcome> finished() noexcept {
    if (!std::exchange(is_done_, false)) return std::nullopt;
    return outcome_;
  }

  /// Something to tell, once.
  [[nodiscard]] constexpr notice noticed() noexcept { return std::exchange(notice_, notice::none); }

  /// Whether a request is under way or its outcome is still to be fetched.
  [[nodiscard]] constexpr bool is_busy() const noexcept { return has_request_ || is_done_; }

  /// Whether the device scans because it was asked to, or is being brought back to it.
  [[nodiscard]] constexpr bool is_scanning() const noexcept { return scanning_; }

  /// Which way the power-down protection is known to be.
  [[nodiscard]] constexpr std::optional<power_down_protection> protection() const noexcept {
    return watch_.protection();
  }

  /// Commands sent again because no believable answer came, and how often the line was cleared.
  [[nodiscard]] constexpr std::uint64_t retries() const noexcept { return retries_; }
  [[nodiscard]] constexpr std::uint64_t cleared_lines() const noexcept { return cleared_; }

  /// The line was opened anew: nothing is known of the device, and nothing asked of it any more.
  constexpr void reset() noexcept {
    const std::uint64_t retries = retries_;
    const std::uint64_t cleared = cleared_;
    *this = session(times_);
    retries_ = retries;
    cleared_ = cleared;
  }

 private:
  friend struct session_state;  // of the test that explores all of them

  enum class phase : std::uint8_t { rest, draining, asking, clearing, starting, booting };
  enum class resume : std::uint8_t { no, later, now };

  static constexpr int max_tries = 3;       // to stop, to start, to clear the line
  static constexpr int max_intrusions = 3;  // of packets into the questions of one request
  static constexpr std::uint8_t all_kinds = 0xFF;

  // ---- requests ----
  constexpr void take_up(const request& wanted, std::int64_t now_ns) noexcept {
    outcome_ = outcome{};
    outcome_.asked = wanted;
    steps_ = request_steps(wanted);
    has_request_ = true;
    is_fencing_ = is_broken_ = false;
    intrusions_ = start_tries_ = 0;
    limit_ns_ = now_ns + times_.request_ns;
    watch_.forget_restarts();
  }

  /// The line is drained: the request proper.
  constexpr void go(std::int64_t now_ns) noexcept {
    switch (outcome_.asked.what) {
      case ask::stop:
        return publish();
      case ask::start:
        return send_start(now_ns);
      case ask::restart:
        return boot(now_ns);
      default:
        return act(steps_.first(), now_ns);
    }
  }

  constexpr void act(const request_step& next, std::int64_t now_ns) noexcept {
    switch (next.what) {
      case request_step::action::ask:
        code_ = next.code;
        is_fencing_ = !next.foretold && wants_fence(next.code);
        return is_fencing_ ? ask_known(now_ns) : ask_device(now_ns);
      case request_step::action::doubt:
        return distrust(now_ns);
      case request_step::action::end:
        return end(next.how, next.value, now_ns);
      case request_step::action::give_up:
        break;
    }
    end(verdict::timed_out, {}, now_ns);
  }

  constexpr void end(verdict how, const answer& value, std::int64_t now_ns) noexcept {
    outcome_.how = how;
    outcome_.value = value;
    if (how == verdict::timed_out) {
      is_idle_ = false;
      doubt_ = all_kinds;
    }
    if (resume_ != resume::later) return publish();
    resume_ = resume::now;
    start_tries_ = 0;
    return is_idle_ ? send_start(now_ns) : drain(now_ns);
  }

  constexpr void publish() noexcept {
    phase_ = phase::rest;
    resume_ = resume::no;
    has_request_ = false;
    is_done_ = true;
  }

  // ---- sending ----
  /// What has not been fetched yet is out of date.
  constexpr void send(command code) noexcept {
    queue_[0] = code;
    queued_ = 1;
    sent_ = 0;
  }
  constexpr void send_stop() noexcept {
    queue_ = {command::forced_stop, command::stop};
    queued_ = 2;
    sent_ = 0;
  }
  constexpr void enter(phase next, std::int64_t deadline_ns) noexcept {
    phase_ = next;
    deadline_ns_ = deadline_ns;
  }

  // ---- draining ----
  constexpr void drain(std::int64_t now_ns) noexcept {
    drains_ = 0;
    tell_to_stop(now_ns);
  }
  constexpr void tell_to_stop(std::int64_t now_ns) noexcept {
    ++drains_;
    is_idle_ = false;
    has_packets_ = false;
    heard_ns_ = now_ns;
    send_stop();
    enter(phase::draining, now_ns + times_.drain_ns);
  }

  constexpr void on_quiet(std::int64_t now_ns) noexcept {
    is_idle_ = true;
    if (wants_start()) return send_start(now_ns);
    if (!has_request_) {
      phase_ = phase::rest;
    } else if (!std::exchange(is_broken_, false)) {
      go(now_ns);
    } else if (outcome_.asked.what == ask::restart) {
      boot(now_ns);
    } else {
      clear(now_ns);
    }
  }

  constexpr void on_unquiet(std::int64_t now_ns) noexcept {
    if (drains_ < max_tries) return tell_to_stop(now_ns);
    if (!has_packets_) return on_quiet(now_ns);  // noise need not keep anyone from asking
    on_unstoppable(now_ns);
  }

  /// Nothing that is sent arrives, most likely. A scan that is wanted goes on.
  constexpr void on_unstoppable(std::int64_t now_ns) noexcept {
    if (resume_ == resume::later) outcome_.how = verdict::still_scanning;
    scanning_ = scanning_ || resume_ != resume::no;
    if (scanning_) return runs(now_ns);
    is_runaway_ = true;
    if (has_request_) return end(verdict::still_scanning, {}, now_ns);
    phase_ = phase::rest;
  }

  // ---- asking ----
  constexpr void ask_device(std::int64_t now_ns) noexcept {
    send(code_);
    enter(phase::asking, now_ns + times_.answer_ns);
  }

  [[nodiscard]] static constexpr std::uint8_t bit(response_kind kind) noexcept {
    return static_cast<std::uint8_t>(1U << static_cast<unsigned>(kind));
  }

  /// Whether an answer to something else could be taken for the one to `code`. A device information
  /// is true whenever it was asked for.
  [[nodiscard]] constexpr bool wants_fence(command code) const noexcept {
    if (code == command::device_info) return false;
    const auto traits = traits_of(code);
    for (const response_layout& layout : response_layouts) {
      if (traits && traits->answered_by == as_reply(layout.kind)) {
        return (doubt_ & bit(layout.kind)) != 0;
      }
    }
    return false;
  }

  constexpr void on_answer(const response_view& reply, std::int64_t now_ns) noexcept {
    const bool may_be_older = (doubt_ & bit(reply.kind())) != 0;
    if (can_answer(code_, reply)) {
      doubt_ =
          bit(reply.kind());  // all earlier questions have been answered; this one perhaps twice
      if (code_ == command::protection_toggle) {
        watch_.set_protection(reply_byte<power_down_protection>(*reply.as_byte()));
      }
      return act(steps_.answered(reply), now_ns);
    }
    if (!may_be_older) distrust(now_ns);
  }

  constexpr void distrust(std::int64_t now_ns) noexcept {
    if (outcome_.wrong_answers < 0xFF) ++outcome_.wrong_answers;
    clear(now_ns);
  }

  // ---- clearing ----
  /// An answer is lost, or an impossible one came.
  constexpr void clear(std::int64_t now_ns) noexcept {
    if (code_ == command::protection_toggle) watch_.set_protection({});
    if (now_ns >= limit_ns_) return end(verdict::timed_out, {}, now_ns);
    ++cleared_;
    clears_ = 0;
    ask_known(now_ns);
  }

  /// Asks what every device answers; by its answer all earlier ones have come. Never the question
  /// that is pending, and by turns, so that a late answer is not taken for the one to the next try.
  constexpr void ask_known(std::int64_t now_ns) noexcept {
    const bool is_odd = clears_++ % 2 == 1;
    command known = is_odd ? command::health : command::device_info;
    if (code_ == command::device_info) known = is_odd ? command::health_vendor : command::health;
    if (code_ == command::health || code_ == command::health_vendor) known = command::device_info;
    if (outcome_.asked.what == ask::restart) known = command::device_info;
    awaited_ = known == command::device_info ? response_kind::device_info : response_kind::health;
    send(known);
    enter(phase::clearing, now_ns + times_.answer_ns);
  }

  constexpr void on_clear(std::int64_t now_ns) noexcept {
    doubt_ = bit(awaited_);
    if (outcome_.asked.what == ask::restart) {
      doubt_ = all_kinds;  // it may have said so by itself
      return end(verdict::answered, {}, now_ns);
    }
    if (std::exchange(is_fencing_, false)) return ask_device(now_ns);
    ++retries_;
    if (outcome_.retries < 0xFF) ++outcome_.retries;
    act(steps_.lost(), now_ns);
  }

  constexpr void on_unclear(std::int64_t now_ns) noexcept {
    const bool is_over =
        outcome_.asked.what == ask::restart ? now_ns >= boot_until_ns_ : clears_ >= max_tries;
    return is_over ? end(verdict::timed_out, {}, now_ns) : ask_known(now_ns);
  }

  // ---- restarting ----
  constexpr void boot(std::int64_t now_ns) noexcept {
    watch_.set_protection({});
    is_old_ = false;
    boot_until_ns_ = now_ns + times_.boot_ns;
    await_boot(command::restart, now_ns);
  }
  constexpr void await_boot(command code, std::int64_t now_ns) noexcept {
    has_signs_ = false;
    send(code);
    enter(phase::booting, now_ns + times_.boot_sign_ns);
  }
  constexpr void on_boot_wait(std::int64_t now_ns) noexcept {
    if (has_signs_ || std::exchange(is_old_, true)) return ask_known(now_ns);
    await_boot(command::restart_old, now_ns);
  }

  // ---- scanning ----
  [[nodiscard]] constexpr bool wants_start() const noexcept {
    if (!has_request_) return scanning_;
    return resume_ == resume::now || outcome_.asked.what == ask::start;
  }

  constexpr void send_start(std::int64_t now_ns) noexcept {
    ++start_tries_;
    is_idle_ = false;
    watch_.start_sent(now_ns);
    send(command::start);
    enter(phase::starting, now_ns + times_.start_ns);
  }

  constexpr void runs(std::int64_t now_ns) noexcept {
    phase_ = phase::rest;
    scanning_ = true;
    watch_.runs(now_ns);
    if (has_request_) publish();
  }

  constexpr void on_start_failed(std::int64_t now_ns) noexcept {
    const bool is_told = has_request_ && resume_ == resume::no;
    scanning_ = false;
    is_idle_ = false;
    doubt_ = all_kinds;
    phase_ = phase::rest;
    send_stop();
    if (!is_told) notice_ = notice::stalled;
    if (is_told) return end(verdict::timed_out, {}, now_ns);
    if (has_request_) publish();
  }

  constexpr void look_at_scan(std::int64_t now_ns) noexcept {
    if (!scanning_) return;
    switch (watch_.look(now_ns, times_)) {
      case scan_need::nothing:
        return;
      case scan_need::feed:
        watch_.start_sent(now_ns);
        return send(command::start);
      case scan_need::starved:
        notice_ = notice::protection_starved;
        start_tries_ = 0;
        return send_start(now_ns);
      case scan_need::found_protected:
        notice_ = notice::protection_found_on;
        break;
      case scan_need::restart:
        notice_ = notice::restarted;
        break;
      case scan_need::give_up:
        notice_ = notice::stalled;
        scanning_ = false;
        break;
    }
    start_tries_ = 0;
    surprise_ = false;
    drain(now_ns);
  }

  // ---- what comes ----
  constexpr void count(const event& found) noexcept {
    heard_from_device& heard = outcome_.heard;
    if (const auto* noise = std::get_if<skipped>(&found)) {
      heard.skipped_bytes += static_cast<std::uint32_t>(noise->count);
    } else {
      ++(std::get_if<packet_view>(&found) != nullptr ? heard.packets : heard.responses);
    }
  }

  constexpr void on_response(const response_view& reply, std::int64_t now_ns) noexcept {
    switch (phase_) {
      case phase::asking:
        return on_answer(reply, now_ns);
      case phase::clearing:
        if (reply.kind() == awaited_) on_clear(now_ns);
        return;
      case phase::starting:
        if (reply.kind() == response_kind::scan_started) runs(now_ns);
        return;
      case phase::rest:
      case phase::draining:
      case phase::booting:
        break;
    }
    doubt_ = static_cast<std::uint8_t>(doubt_ | bit(reply.kind()));
  }

  constexpr void on_packet(std::int64_t now_ns) noexcept {
    switch (phase_) {
      case phase::starting:
        runs(now_ns);
        return watch_.packet(now_ns);
      case phase::draining:
        has_packets_ = true;
        if (std::exchange(surprise_, false)) notice_ = notice::found_scanning;
        return;
      case phase::rest:
        if (scanning_) return watch_.packet(now_ns);
        if (is_runaway_) return;
        notice_ = notice::found_scanning;
        break;
      case phase::asking:
      case phase::clearing:
      case phase::booting:
        if (++intrusions_ > max_intrusions) {
          is_runaway_ = true;
          is_idle_ = false;
          return end(verdict::still_scanning, {}, now_ns);
        }
        is_broken_ = true;
        break;
    }
    surprise_ = false;
    drain(now_ns);
  }

  session_times times_;
  phase phase_ = phase::rest;
  resume resume_ = resume::no;  // the scan that a request has interrupted
  bool has_request_ = false;
  bool is_done_ = false;      // its outcome has not been fetched
  bool is_idle_ = false;      // the device has been heard to fall silent, and not told to start
  bool scanning_ = false;     // it is to scan
  bool is_runaway_ = false;   // it scans and cannot be stopped
  bool surprise_ = false;     // a packet while draining would be one that nobody wanted
  bool has_packets_ = false;  // packets came after it was told to stop
  bool has_signs_ = false;    // anything came after it was told to restart
  bool is_old_ = false;       // it has been told to restart in the old way
  bool is_fencing_ = false;   // the line is cleared before a question and not after it
  bool is_broken_ = false;    // packets came instead of an answer
  std::uint8_t drains_ = 0;
  std::uint8_t clears_ = 0;
  std::uint8_t start_tries_ = 0;
  std::uint8_t intrusions_ = 0;
  std::uint8_t doubt_ = all_kinds;       // kinds of answers that may still come unasked, a bit each
  command code_ = command::device_info;  // the question that is pending
  response_kind awaited_ = response_kind::device_info;  // while clearing
  std::array<command, 2> queue_{};
  std::uint8_t queued_ = 0;
  std::uint8_t sent_ = 0;
  notice notice_ = notice::none;
  request_steps steps_;
  scan_watch watch_;
  outcome outcome_{request{ask::device_info}};
  std::int64_t heard_ns_ = 0;
  std::int64_t deadline_ns_ = 0;
  std::int64_t limit_ns_ = 0;
  std::int64_t boot_until_ns_ = 0;
  std::uint64_t retries_ = 0;
  std::uint64_t cleared_ = 0;
};

}  // namespace g4lidar
