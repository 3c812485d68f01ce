// SPDX-License-Identifier: MIT
// The single operations on a device: stop the stream, query, start, restart.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <variant>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/session/pending_command.hpp"
#include "g4lidar/core/session_times.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {

/// The result of an operation.
enum class channel_state : std::uint8_t {
  going_on,
  quiet,        ///< Of drain(): no more bytes arrive, or only noise.
  streaming,    ///< Of drain(): packets arrive despite several stop commands.
  answered,     ///< Of ask(): the last response is the answer.
  wrong,        ///< Of ask(): the last response cannot be the answer. The operation continues.
  lost,         ///< Of ask() and clear(): the link is clear, and there is no answer.
  silent,       ///< Of ask(), clear() and restart(): no response to any command.
  disturbed,    ///< Of ask(), clear() and restart(): a packet arrived.
  running,      ///< Of start(): the scan header or a packet arrived.
  not_started,  ///< Of start(): neither arrived.
  restarted,    ///< Of restart(): the device answers again.
};

/// One operation at a time, each of bounded duration. *Single thread.* session.hpp has the table.
class command_channel {
 public:
  /// No operation, with these times.
  explicit constexpr command_channel(const session_times& times) noexcept : times_(times) {}

  /// Stops the device and waits for silence.
  constexpr void drain(std::int64_t now_ns) noexcept {
    drains_ = 0;
    send_stop(now_ns);
  }
  /// Sends a query; see pending_command. After a disturbance, when the device is silent again,
  /// clear() continues the same query; also after an answer that the caller does not accept.
  constexpr void ask(command code, bool has_one_answer, std::int64_t now_ns) noexcept {
    question_.ask(code, has_one_answer);
    send_question(now_ns);
  }
  /// Clears the link, and sends the same query again.
  constexpr void clear(std::int64_t now_ns) noexcept {
    question_.clear();
    send_question(now_ns);
  }
  /// Starts the scan: ends with running or not_started.
  constexpr void start(std::int64_t now_ns) noexcept {
    send(command::start);
    enter(act::starting, detail::saturating_add(now_ns, times_.start_ns));
  }
  /// Restarts the device: ends with restarted or silent.
  constexpr void restart(std::int64_t now_ns) noexcept {
    is_old_ = false;
    boot_until_ns_ = detail::saturating_add(now_ns, times_.boot_ns);
    await_boot(command::restart, now_ns);
  }
  /// Ends the operation.
  constexpr void rest() noexcept { act_ = act::none; }
  /// Sends without waiting.
  constexpr void send(command code) noexcept {
    queue_[0] = code;  // an older unsent command is obsolete
    queued_ = 1;
    fetched_ = 0;
  }
  /// Sends both forms of a stop, without waiting.
  constexpr void send_stop() noexcept {
    queue_ = {command::forced_stop, command::stop};
    queued_ = 2;
    fetched_ = 0;
  }

  /// Passes an event of the parser.
  [[nodiscard]] constexpr channel_state take(const event& found, std::int64_t now_ns) noexcept {
    heard_ns_ = std::max(heard_ns_, now_ns);
    has_signs_ = !is_unsent();
    if (const auto* heard = std::get_if<response_view>(&found)) return on_response(*heard, now_ns);
    if (std::get_if<packet_view>(&found) != nullptr) return on_packet();
    return channel_state::going_on;
  }

  /// Passes the time.
  [[nodiscard]] constexpr channel_state look(std::int64_t now_ns) noexcept {
    if (now_ns < next_look_ns()) return channel_state::going_on;
    switch (act_) {
      case act::draining:
        if (now_ns >= detail::saturating_add(heard_ns_, times_.quiet_ns))
          return channel_state::quiet;
        if (drains_ == max_drains)
          return has_packets_ ? channel_state::streaming : channel_state::quiet;
        send_stop(now_ns);
        break;
      case act::asking:
        return on_question(question_.late(), now_ns);
      case act::starting:
        return channel_state::not_started;
      case act::booting:
        has_signs_ || is_old_ ? probe(now_ns) : await_boot(command::restart_old, now_ns);
        break;
      case act::probing:
        if (now_ns >= boot_until_ns_) return channel_state::silent;
        probe(now_ns);
        break;
      case act::none:
        break;
    }
    return channel_state::going_on;
  }

  /// When look() is due, if nothing arrives; the highest value for never.
  [[nodiscard]] constexpr std::int64_t next_look_ns() const noexcept {
    switch (act_) {
      case act::none:
        return std::numeric_limits<std::int64_t>::max();
      case act::draining:
        return std::min(detail::saturating_add(heard_ns_, times_.quiet_ns), deadline_ns_);
      case act::booting:
        if (has_signs_)
          return std::min(
              detail::saturating_add(heard_ns_, detail::saturating_twice(times_.quiet_ns)),
              boot_until_ns_);
        break;
      default:
        break;
    }
    return deadline_ns_;
  }

  /// The next command to write to the transport, each once; nothing if there is none.
  [[nodiscard]] constexpr std::optional<std::array<std::uint8_t, 2>> to_send() noexcept {
    if (!is_unsent()) return std::nullopt;
    return encode(queue_[fetched_++]);
  }

  /// Whether a command has not been fetched yet: received bytes are not an answer to it.
  [[nodiscard]] constexpr bool is_unsent() const noexcept { return fetched_ != queued_; }
  /// Whether there is no operation.
  [[nodiscard]] constexpr bool is_at_rest() const noexcept { return act_ == act::none; }
  /// Whether it waits for silence.
  [[nodiscard]] constexpr bool is_draining() const noexcept { return act_ == act::draining; }
  /// The current or last query.
  [[nodiscard]] constexpr pending_command& question() noexcept { return question_; }
  /// The times that were given to the constructor.
  [[nodiscard]] constexpr const session_times& times() const noexcept { return times_; }

 private:
  friend struct session_test_access;
  enum class act : std::uint8_t { none, draining, asking, starting, booting, probing };
  static constexpr int max_drains = 3;  // the number of attempts to stop a device

  constexpr void enter(act next, std::int64_t deadline_ns) noexcept {
    act_ = next;
    deadline_ns_ = deadline_ns;
  }
  constexpr void send_stop(std::int64_t now_ns) noexcept {
    ++drains_;
    has_packets_ = false;
    heard_ns_ = now_ns;
    send_stop();
    enter(act::draining, detail::saturating_add(now_ns, times_.drain_ns));
  }
  /// A device that may be booting gets more time for its first answer, and a device whose last
  /// answer was slow for each answer.
  constexpr void send_question(std::int64_t now_ns) noexcept {
    send(question_.code_to_send());
    std::int64_t wait_ns = times_.answer_ns;
    if (question_.is_patient()) wait_ns = detail::saturating_twice(wait_ns);
    if (is_slow_ || (is_new_ && !question_.is_clearing())) {
      wait_ns = std::max(wait_ns, times_.first_answer_ns);
    }
    slow_from_ns_ = detail::saturating_add(now_ns, times_.answer_ns);
    enter(act::asking, detail::saturating_add(now_ns, wait_ns));
  }
  constexpr void await_boot(command code, std::int64_t now_ns) noexcept {
    is_old_ = code == command::restart_old;
    has_signs_ = false;
    send(code);
    enter(act::booting, detail::saturating_add(now_ns, times_.boot_sign_ns));
  }
  constexpr void probe(std::int64_t now_ns) noexcept {
    send(command::device_info);
    enter(act::probing,
          detail::saturating_add(now_ns, std::max(times_.answer_ns, times_.first_answer_ns)));
  }

  constexpr channel_state on_question(question_state now, std::int64_t now_ns) noexcept {
    switch (now) {
      case question_state::waiting:
        break;
      case question_state::send:
        send_question(now_ns);
        break;
      case question_state::answered:
        return channel_state::answered;
      case question_state::lost:
        return channel_state::lost;
      case question_state::silent:
        return channel_state::silent;
    }
    return channel_state::going_on;
  }

  constexpr channel_state on_response(const response_view& heard, std::int64_t now_ns) noexcept {
    if (is_unsent()) {
      question_.take_unasked(heard);
      return channel_state::going_on;
    }
    switch (act_) {
      case act::asking: {
        const bool was_clearing = question_.is_clearing();
        const std::int64_t slow_from_ns = slow_from_ns_;
        const channel_state now = on_question(question_.take(heard), now_ns);
        if (now == channel_state::answered) {
          is_slow_ = now_ns > slow_from_ns;
          is_new_ = false;
        }
        return !was_clearing && question_.is_clearing() ? channel_state::wrong : now;
      }
      case act::starting:
        if (heard.kind() == response_kind::scan_started) return channel_state::running;
        break;
      case act::probing:
        if (heard.kind() != response_kind::device_info) break;
        question_.take_unasked(heard);  // it may have been sent unasked, before the answer
        return channel_state::restarted;
      case act::none:
      case act::draining:
      case act::booting:
        question_.take_unasked(heard);
        break;
    }
    return channel_state::going_on;
  }

  constexpr channel_state on_packet() noexcept {
    has_packets_ = true;
    if (act_ == act::starting)
      return is_unsent() ? channel_state::going_on : channel_state::running;
    const bool is_free = act_ == act::none || act_ == act::draining;
    return is_free ? channel_state::going_on : channel_state::disturbed;
  }

  session_times times_;
  pending_command question_;
  act act_ = act::none;
  std::uint8_t drains_ = 0;
  bool has_packets_ = false;  // packets arrived after the stop command
  bool has_signs_ = false;    // anything arrived after the restart command
  bool is_old_ = false;       // the old restart command was sent
  bool is_new_ = true;        // it has not answered yet
  bool is_slow_ = false;      // its last answer was slow
  std::uint8_t queued_ = 0;
  std::uint8_t fetched_ = 0;
  std::array<command, 2> queue_{};
  std::int64_t heard_ns_ = 0;
  std::int64_t deadline_ns_ = 0;
  std::int64_t slow_from_ns_ = 0;  // later answers are slow
  std::int64_t boot_until_ns_ = 0;
};

}  // namespace g4lidar
