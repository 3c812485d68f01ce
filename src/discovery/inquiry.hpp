// SPDX-License-Identifier: MIT
// The question who sends packets.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <variant>

#include "g4lidar/core/request.hpp"
#include "g4lidar/core/session_times.hpp"
#include "g4lidar/error.hpp"
#include "link/device_link.hpp"

namespace g4lidar {

/// How often a device gets the commands of a stop.
enum class stop_attempts : std::uint8_t {
  one,      ///< It may be one that has no commands.
  several,  ///< Until packets end.
};

/// One query to a device that sends packets: it is stopped first.
class inquiry {
 public:
  /// `samples` as the device sends them.
  inquiry(transport& port, sample_format samples, stop_attempts attempts) noexcept
      : port_(port), how_(attempts), input_(samples), link_(input_, &port, times_for(attempts)) {}

  [[nodiscard]] result<device_information> ask(std::int64_t deadline_ns) {
    session& talk = link_.talk();
    const std::int64_t begin_ns = port_.now_ns();
    static_cast<void>(talk.begin(requests::device_info(), begin_ns));
    while (port_.now_ns() < deadline_ns) {
      const auto sent = link_.send([&](bytes out) { return port_.write(out, deadline_ns); });
      if (!sent) return tl::unexpected(sent.error());
      if (const auto ended = talk.finished()) return judge(*ended);
      const auto got = link_.receive(buffer_, std::min(link_.due_ns(), deadline_ns));
      if (!got) return tl::unexpected(got.error());
      bool still_sends = false;
      link_.events([&](const event& found) {
        has_heard_ = true;
        still_sends = still_sends || std::holds_alternative<packet_view>(found);
      });
      has_packets_ = has_packets_ || still_sends;
      const bool is_late = port_.now_ns() > begin_ns + slowest_stop_ns;
      if (how_ == stop_attempts::one && still_sends && is_late) return nothing_believable();
      if (port_.now_ns() >= talk.next_look_ns()) talk.look(port_.now_ns());
    }
    return nothing_believable();
  }

 private:
  /// What sends a packet after this time does not stop: answers are known that take 350 ms.
  static constexpr std::int64_t slowest_stop_ns = 380'000'000;

  /// A stop is repeated when the stream has not ended in the time for it.
  [[nodiscard]] static session_times times_for(stop_attempts how) noexcept {
    session_times times;
    if (how == stop_attempts::one) times.drain_ns = times.request_ns;
    return times;
  }

  [[nodiscard]] result<device_information> judge(const outcome& ended) const {
    const auto* device = std::get_if<device_information>(&ended.value);
    if (ended.how != verdict::answered || device == nullptr) return nothing_believable();
    return *device;
  }

  [[nodiscard]] tl::unexpected<error> nothing_believable() const noexcept {
    const problem why = has_packets_ ? problem::does_not_stop
                        : has_heard_ ? problem::garbage
                                     : problem::silence;
    return failure(task::asking, why, port_.name());
  }

  transport& port_;
  stop_attempts how_;
  event_reader input_;
  device_link link_;
  std::array<std::uint8_t, 4096> buffer_{};
  bool has_heard_ = false;
  bool has_packets_ = false;
};

}  // namespace g4lidar
