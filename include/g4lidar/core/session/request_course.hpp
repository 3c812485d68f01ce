// SPDX-License-Identifier: MIT
// The request in progress: its steps, what was heard during it, and its outcome.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <variant>

#include "g4lidar/core/request.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/session/request_retry.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace g4lidar {

/// *Single thread.*
class request_course {
 public:
  /// Begins a request. It ends at the first lost answer after `limit_ns`.
  constexpr void begin(const request& wanted, std::int64_t limit_ns, const model& model) noexcept {
    outcome_ = outcome{};
    outcome_.asked = wanted;
    steps_ = request_retry(wanted, model);
    is_running_ = true;
    is_broken_ = false;
    disturbances_ = 0;
    limit_ns_ = limit_ns;
  }
  /// Of the current or last request.
  [[nodiscard]] constexpr request_kind kind() const noexcept { return outcome_.asked.what; }
  /// Whether end() follows.
  [[nodiscard]] constexpr bool is_running() const noexcept { return is_running_; }
  /// Whether finished() returns an outcome.
  [[nodiscard]] constexpr bool is_done() const noexcept { return is_done_; }

  /// The first step.
  [[nodiscard]] constexpr request_step first() const noexcept { return steps_.first(); }
  /// The step after this answer.
  [[nodiscard]] constexpr request_step answered(const response_view& heard) noexcept {
    return steps_.answered(heard);
  }
  /// The step after a lost answer.
  [[nodiscard]] constexpr request_step lost(std::int64_t now_ns) noexcept {
    if (now_ns >= limit_ns_) return {};
    const request_step next = steps_.lost();
    if (next.what == request_step::action::ask) {
      ++retries_;
      if (outcome_.retries < 0xFF) ++outcome_.retries;
    }
    return next;
  }
  /// Packets arrived instead of an answer. False if this has happened too often.
  [[nodiscard]] constexpr bool disturbed() noexcept {
    if (++disturbances_ > max_disturbances) return false;
    is_broken_ = true;
    return true;
  }
  /// Whether packets arrived instead of an answer, since the last call.
  [[nodiscard]] constexpr bool take_broken() noexcept { return std::exchange(is_broken_, false); }

  /// An event of the parser.
  constexpr void count(const event& found) noexcept {
    if (!is_running_) return;
    heard_from_device& heard = outcome_.heard;
    if (const auto* noise = std::get_if<skipped>(&found)) {
      heard.skipped_bytes += static_cast<std::uint32_t>(noise->count);
    } else if (std::holds_alternative<packet_view>(found)) {
      ++heard.packets;
    } else if (std::holds_alternative<response_view>(found)) {
      ++heard.responses;
    }
  }
  /// An answer was impossible.
  constexpr void count_wrong() noexcept {
    if (outcome_.wrong_answers < 0xFF) ++outcome_.wrong_answers;
  }
  /// So many starts were sent for it.
  constexpr void count_starts(std::uint8_t starts) noexcept {
    if (is_running_) outcome_.starts = starts;
  }

  /// The outcome, if nothing else happens before end().
  constexpr void decide(verdict verdict, const answer& value) noexcept {
    outcome_.how = verdict;
    outcome_.value = value;
  }
  /// It has ended.
  constexpr void end() noexcept {
    is_running_ = false;
    is_done_ = true;
  }
  /// The outcome, once.
  [[nodiscard]] constexpr std::optional<outcome> finished() noexcept {
    if (!std::exchange(is_done_, false)) return std::nullopt;
    return outcome_;
  }
  /// Of all requests.
  [[nodiscard]] constexpr std::uint64_t retries() const noexcept { return retries_; }
  /// There is no request, and there was none. The retries are still counted.
  constexpr void reset() noexcept {
    const std::uint64_t retries = retries_;
    *this = request_course();
    retries_ = retries;
  }

 private:
  friend struct session_test_access;
  static constexpr int max_disturbances = 3;

  request_retry steps_;
  outcome outcome_{request{request_kind::device_info}};
  bool is_running_ = false;
  bool is_done_ = false;    // its outcome has not been taken
  bool is_broken_ = false;  // packets arrived instead of an answer
  std::uint8_t disturbances_ = 0;
  std::int64_t limit_ns_ = 0;
  std::uint64_t retries_ = 0;
};

}  // namespace g4lidar
