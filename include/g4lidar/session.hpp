// SPDX-License-Identifier: MIT
// The command/response session: what to send, when to look again, and what became of a request.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <variant>

#include "g4lidar/command.hpp"
#include "g4lidar/device_talk.hpp"
#include "g4lidar/request.hpp"
#include "g4lidar/request_steps.hpp"
#include "g4lidar/response.hpp"
#include "g4lidar/scan_watch.hpp"
#include "g4lidar/stream_parser.hpp"

namespace g4lidar {

/// Commands and their answers over a line that loses, delays and repeats. *Single thread*; knows no
/// clock and does no I/O. The caller shows it all events of the parser and the time, sends what it
/// says, and looks again when it says. When nothing has come for a while, stream_parser::finish()
/// comes before look(): a stopped stream leaves half a packet behind that would swallow an answer.
///
///     state     sent     ends by                        and then
///     --------  -------  -----------------------------  ------------------------------------------
///     rest      (60)     a packet, no scan wanted       draining
///                        the wanted scan falls silent   draining, then starting
///                        it is fed too late             starting
///     draining  00 65    silence                        what it was for: rest, starting, asking,
///                                                       booting; clearing if it broke a question
///                        none, told often enough        the end: still scanning
///     asking    a        a possible answer              asking the next, or the end
///               command  an impossible one, none        clearing
///                        a packet                       draining, then clearing
///     clearing  90 (91)  its answer; all before it is   asking: again what may be repeated, else
///                        thrown away                    the state that it moves
///                        no answer, asked often enough  the end: timed out
///     starting  60       the scan header or a packet    rest, scanning; the end
///                        neither                        draining, then starting; or the end
///     booting   80 (40)  silence after the boot text,   probing
///                        or nothing at all
///     probing   90       its answer, or none in time    the end
///
/// The end is rest with an outcome, or starting where a scan is to be resumed. Every state but rest
/// has a deadline, and every way round in the table is counted, so each request ends.
/// (protocol: Commands; The stream)
class session {
 public:
  /// At rest; nothing is known of the device.
  explicit constexpr session(const session_times& times = {}) noexcept : talk_(times) {}

  /// Begins a request, or says why not. The first one after the line was opened stops the device,
  /// which may be scanning.
  [[nodiscard]] constexpr std::optional<refusal> begin(
      const request& wanted, std::int64_t now_ns,
      while_scanning how = while_scanning::refuse) noexcept {
    if (is_busy()) return refusal::busy;
    const bool disturbs = wanted.what != ask::start && wanted.what != ask::stop;
    if (scanning_ && disturbs && how == while_scanning::refuse) return refusal::scanning;
    take_up(wanted, now_ns);
    if (wanted.what == ask::start && scanning_) {
      if (talk_.is_at_rest()) publish();
      return std::nullopt;  // otherwise it is being started already
    }
    resume_ = scanning_ && disturbs ? resume::later : resume::no;
    surprise_ = !scanning_ && !talk_.is_draining();
    scanning_ = false;
    if (wanted.what != ask::stop && is_idle_) {
      go(now_ns);
    } else if (wanted.what == ask::stop || !talk_.is_draining()) {
      drain(now_ns);
    }
    return std::nullopt;
  }

  /// Shows an event of the parser and when its bytes came. Every event, the skipped bytes too.
  constexpr void take(const event& found, std::int64_t now_ns) noexcept {
    if (has_request_) count(found);
    const bool was_at_rest = talk_.is_at_rest();
    const talk_state now = talk_.take(found, now_ns);
    if (now == talk_state::answered) {
      return on_answer(*std::get_if<response_view>(&found), now_ns);
    }
    on_talk(now, now_ns);
    if (std::get_if<packet_view>(&found) != nullptr) on_packet(was_at_rest, now_ns);
  }

  /// Lets time pass: call it when next_look_ns() has come, after the events from before then.
  constexpr void look(std::int64_t now_ns) noexcept {
    if (!talk_.is_at_rest()) return on_talk(talk_.look(now_ns), now_ns);
    if (scanning_) on_need(watch_.look(now_ns, talk_.times()), now_ns);
  }

  /// When to look again even if nothing comes; the largest number where nothing is awaited.
  [[nodiscard]] constexpr std::int64_t next_look_ns() const noexcept {
    if (scanning_ && talk_.is_at_rest()) return watch_.next_look_ns(talk_.times());
    return talk_.next_look_ns();
  }

  /// The next command to send, once; call until it gives nothing, after every other call, or after
  /// all events of what was read together: none of those is taken for an answer to it.
  [[nodiscard]] constexpr std::optional<std::array<std::uint8_t, 2>> to_send() noexcept {
    return talk_.to_send();
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

  /// Whether to_send(), finished() and noticed() all have nothing: one question for the three.
  [[nodiscard]] constexpr bool has_nothing() const noexcept {
    return !is_done_ && notice_ == notice::none && !talk_.is_unsent();
  }

  /// Whether the device scans because it was asked to, or is being brought back to it.
  [[nodiscard]] constexpr bool is_scanning() const noexcept { return scanning_; }

  /// Which way the power-down protection is known to be.
  [[nodiscard]] constexpr std::optional<power_down_protection> protection() const noexcept {
    return watch_.protection();
  }

  /// Commands sent again because no believable answer came.
  [[nodiscard]] constexpr std::uint64_t retries() const noexcept { return retries_; }

  /// The line was opened anew: nothing is known of the device, and nothing asked of it any more.
  constexpr void reset() noexcept {
    const std::uint64_t retries = retries_;
    *this = session(talk_.times());
    retries_ = retries;
  }

 private:
  friend struct session_state;  // of the test that explores all of them

  enum class resume : std::uint8_t { no, later, now };

  static constexpr int max_starts = 3;  // before a device is taken for one that does not start
  static constexpr int max_disturbances = 3;  // of one request, by packets

  // ---- the course of a request ----
  constexpr void take_up(const request& wanted, std::int64_t now_ns) noexcept {
    outcome_ = outcome{};
    outcome_.asked = wanted;
    steps_ = request_steps(wanted);
    has_request_ = true;
    is_broken_ = false;
    disturbances_ = starts_ = 0;
    limit_ns_ = now_ns + talk_.times().request_ns;
    watch_.forget_restarts();
    talk_.question().be_quick();
  }

  constexpr void drain(std::int64_t now_ns) noexcept {
    is_idle_ = false;
    talk_.drain(now_ns);
  }

  /// The device is idle and silent: the request proper.
  constexpr void go(std::int64_t now_ns) noexcept {
    switch (outcome_.asked.what) {
      case ask::stop:
        return publish();
      case ask::start:
        return start(now_ns);
      case ask::restart:
        watch_.set_protection({});
        return talk_.restart(now_ns);
      default:
        return follow(steps_.first(), now_ns);
    }
  }

  constexpr void follow(const request_step& next, std::int64_t now_ns) noexcept {
    switch (next.what) {
      case request_step::action::ask:
        return talk_.ask(next.code, next.foretold, now_ns);
      case request_step::action::doubt:
        count_wrong();
        return talk_.clear(now_ns);
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
      talk_.question().doubt_all();
    }
    if (resume_ != resume::later) return publish();
    resume_ = resume::now;
    starts_ = 0;
    is_idle_ ? start(now_ns) : drain(now_ns);
  }

  constexpr void publish() noexcept {
    talk_.rest();
    resume_ = resume::no;
    has_request_ = false;
    is_done_ = true;
  }

  // ---- what an act has come to ----
  constexpr void on_talk(talk_state now, std::int64_t now_ns) noexcept {
    switch (now) {
      case talk_state::going_on:
      case talk_state::answered:
        return;
      case talk_state::quiet:
        return on_quiet(now_ns);
      case talk_state::streaming:
        return on_unstoppable(now_ns);
      case talk_state::wrong:
        return count_wrong();
      case talk_state::lost:
        return on_lost(now_ns);
      case talk_state::silent:
        forget_toggle();
        return end(verdict::timed_out, {}, now_ns);
      case talk_state::disturbed:
        return on_disturbed(now_ns);
      case talk_state::running:
        return on_running(now_ns);
      case talk_state::not_started:
        return starts_ == max_starts ? on_start_failed(now_ns) : drain(now_ns);
      case talk_state::restarted:
        return end(verdict::answered, {}, now_ns);
    }
  }

  constexpr void on_quiet(std::int64_t now_ns) noexcept {
    is_idle_ = true;
    is_runaway_ = false;
    if (wants_start()) return start(now_ns);
    if (!has_request_) return talk_.rest();
    if (!std::exchange(is_broken_, false) || outcome_.asked.what == ask::restart) {
      return go(now_ns);
    }
    talk_.clear(now_ns);
  }

  /// Nothing that is sent arrives, most likely. A scan that is wanted goes on.
  constexpr void on_unstoppable(std::int64_t now_ns) noexcept {
    if (resume_ == resume::later) outcome_.how = verdict::still_scanning;
    if (scanning_ || resume_ != resume::no) return on_running(now_ns);
    is_runaway_ = true;
    if (has_request_) return end(verdict::still_scanning, {}, now_ns);
    talk_.rest();
  }

  constexpr void on_answer(const response_view& heard, std::int64_t now_ns) noexcept {
    const auto byte = heard.as_byte();
    if (byte && talk_.question().code() == command::protection_toggle) {
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
      talk_.question().doubt_all();
      forget_toggle();
      return end(verdict::still_scanning, {}, now_ns);
    }
    is_broken_ = true;
    drain(now_ns);
  }

  constexpr void forget_toggle() noexcept {
    if (talk_.question().code() == command::protection_toggle) watch_.set_protection({});
  }

  // ---- scanning ----
  [[nodiscard]] constexpr bool wants_start() const noexcept {
    if (!has_request_) return scanning_;
    return resume_ == resume::now || outcome_.asked.what == ask::start;
  }

  constexpr void start(std::int64_t now_ns) noexcept {
    ++starts_;
    is_idle_ = false;
    watch_.start_sent(now_ns);
    talk_.start(now_ns);
  }

  constexpr void on_running(std::int64_t now_ns) noexcept {
    talk_.rest();
    scanning_ = true;
    watch_.runs(now_ns);
    if (has_request_) publish();
  }

  constexpr void on_start_failed(std::int64_t now_ns) noexcept {
    scanning_ = is_idle_ = false;
    talk_.rest();
    talk_.send_stop();  // it may have heard what was not answered
    talk_.question().doubt_all();
    if (has_request_ && resume_ == resume::no) return end(verdict::timed_out, {}, now_ns);
    notice_ = notice::stalled;
    if (has_request_) publish();
  }

  constexpr void on_need(scan_need need, std::int64_t now_ns) noexcept {
    switch (need) {
      case scan_need::nothing:
        return;
      case scan_need::feed:
        watch_.start_sent(now_ns);
        return talk_.send(command::start);
      case scan_need::starved:
        notice_ = notice::protection_starved;
        starts_ = 0;
        return start(now_ns);
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
    starts_ = 0;
    surprise_ = false;
    drain(now_ns);
  }

  /// A packet: of a wanted scan, or of one that is told of once and stopped.
  constexpr void on_packet(bool was_at_rest, std::int64_t now_ns) noexcept {
    if (scanning_) return watch_.packet(now_ns);
    if (talk_.is_draining() && std::exchange(surprise_, false)) notice_ = notice::found_scanning;
    if (!was_at_rest || is_runaway_) return;
    notice_ = notice::found_scanning;
    surprise_ = false;
    drain(now_ns);
  }

  constexpr void count(const event& found) noexcept {
    heard_from_device& heard = outcome_.heard;
    if (const auto* noise = std::get_if<skipped>(&found)) {
      heard.skipped_bytes += static_cast<std::uint32_t>(noise->count);
    } else {
      ++(std::get_if<packet_view>(&found) != nullptr ? heard.packets : heard.responses);
    }
  }
  constexpr void count_wrong() noexcept {
    if (outcome_.wrong_answers < 0xFF) ++outcome_.wrong_answers;
  }

  device_talk talk_;
  scan_watch watch_;
  request_steps steps_;
  outcome outcome_{request{ask::device_info}};
  notice notice_ = notice::none;
  resume resume_ = resume::no;  // of the scan that the request has interrupted
  bool has_request_ = false;
  bool is_done_ = false;     // its outcome has not been fetched
  bool scanning_ = false;    // the device is to scan
  bool is_idle_ = false;     // it has fallen silent, and was not told to start since
  bool is_runaway_ = false;  // it scans and cannot be stopped
  bool surprise_ = false;    // a packet while draining would be one that nobody wanted
  bool is_broken_ = false;   // packets came instead of an answer
  std::uint8_t disturbances_ = 0;
  std::uint8_t starts_ = 0;  // sent, without a scan
  std::int64_t limit_ns_ = 0;
  std::uint64_t retries_ = 0;
};

}  // namespace g4lidar
