// SPDX-License-Identifier: MIT
// The command/response session: what to send, when to call again, and the outcome of a request.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "g4lidar/core/request.hpp"
#include "g4lidar/core/session/session_machine.hpp"
#include "g4lidar/core/session_times.hpp"
#include "g4lidar/core/stream_parser.hpp"

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
  /// In the state rest; nothing is known about the device.
  explicit constexpr session(const session_times& times = {}) noexcept : machine_(times) {}

  /// Begins a request, or returns why it is refused. The first request after the connection was
  /// opened stops the device, which may be scanning.
  [[nodiscard]] constexpr std::optional<refusal> begin(
      const request& wanted, std::int64_t now_ns,
      while_scanning how = while_scanning::refuse) noexcept {
    return machine_.begin(wanted, now_ns, how);
  }

  /// Passes an event of the parser and its arrival time. Pass every event, also skipped bytes.
  constexpr void take(const event& found, std::int64_t now_ns) noexcept {
    machine_.take(found, now_ns);
  }

  /// Passes the time: call it when next_look_ns() has been reached, after the earlier events.
  constexpr void look(std::int64_t now_ns) noexcept { machine_.look(now_ns); }

  /// When to call look() even if nothing arrives; the largest number if nothing is awaited.
  [[nodiscard]] constexpr std::int64_t next_look_ns() const noexcept {
    return machine_.next_look_ns();
  }

  /// The next command to send, each once. Call it until it returns nothing, after every other call,
  /// or after all events of one read: none of these events is then taken for an answer to the
  /// command.
  [[nodiscard]] constexpr std::optional<std::array<std::uint8_t, 2>> to_send() noexcept {
    return machine_.to_send();
  }

  /// The outcome of the request, once, when it has ended.
  [[nodiscard]] constexpr std::optional<outcome> finished() noexcept { return machine_.finished(); }

  /// The next event to report, each once.
  [[nodiscard]] constexpr notice noticed() noexcept { return machine_.noticed(); }

  /// Whether a request is in progress or its outcome has not been taken.
  [[nodiscard]] constexpr bool is_busy() const noexcept { return machine_.is_busy(); }

  /// Whether to_send(), finished() and noticed() all return nothing.
  [[nodiscard]] constexpr bool has_nothing() const noexcept { return machine_.has_nothing(); }

  /// Whether the device scans because of a start request, or a scan is being resumed.
  [[nodiscard]] constexpr bool is_scanning() const noexcept { return machine_.is_scanning(); }

  /// For how long packets arrived, of the running or the last scan; 0 if none has arrived.
  [[nodiscard]] constexpr std::int64_t scan_length_ns() const noexcept {
    return machine_.scan_length_ns();
  }

  /// The state of the power-down protection, if it is known.
  [[nodiscard]] constexpr std::optional<power_down_protection> protection() const noexcept {
    return machine_.protection();
  }

  /// Commands that were repeated because no valid answer arrived.
  [[nodiscard]] constexpr std::uint64_t retries() const noexcept { return machine_.retries(); }

  /// The connection was opened again: nothing is known about the device, and no request is in
  /// progress.
  constexpr void reset() noexcept { machine_.reset(); }

 private:
  session_machine machine_;
};

}  // namespace g4lidar
