// SPDX-License-Identifier: MIT
// The question who sends packets.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <variant>

#include "driver/device_link.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/session_times.hpp"
#include "g4lidar/error.hpp"

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
  inquiry(transport& port, sample_format samples, stop_attempts how) noexcept
      : port_(port), input_(samples), link_(input_, &port, times_for(how)) {}

  [[nodiscard]] result<device_information> ask(std::int64_t deadline_ns) {
    session& talk = link_.talk();
    static_cast<void>(talk.begin(requests::device_info(), port_.now_ns()));
    while (port_.now_ns() < deadline_ns) {
      const auto sent = link_.send([&](bytes out) { return port_.write(out, deadline_ns); });
      if (!sent) return tl::unexpected(sent.error());
      if (const auto ended = talk.finished()) return judge(*ended);
      const auto got = link_.receive(buffer_, std::min(link_.due_ns(), deadline_ns));
      if (!got) return tl::unexpected(got.error());
      link_.events([this](const event& found) {
        has_heard_ = true;
        has_packets_ = has_packets_ || std::holds_alternative<packet_view>(found);
      });
      if (port_.now_ns() >= talk.next_look_ns()) talk.look(port_.now_ns());
    }
    return nothing_believable();
  }

 private:
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
  event_reader input_;
  device_link link_;
  std::array<std::uint8_t, 4096> buffer_{};
  bool has_heard_ = false;
  bool has_packets_ = false;
};

}  // namespace g4lidar
