// SPDX-License-Identifier: MIT
// What the steps of an acceptance run are made of. Commands are sent as they are, and replies kept as
// bytes: the session would hide what is to be found out.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/transport/transport.hpp"
#include "link_monitor.hpp"
#include "stream_survey.hpp"

namespace g4lidar {

/// After this time of a scan the motor turns steadily.
inline constexpr std::int64_t spun_up_ns = 3'000 * ms;

[[nodiscard]] constexpr double in_ms(std::int64_t ns) noexcept {
  return static_cast<double>(ns) / 1e6;
}

/// "First packet after 9 ms, steady after 1009 ms."
[[nodiscard]] std::string spin_up_words(std::int64_t first_ns, double steady_ms);

/// The bytes that came after a command.
struct raw_reply {
  std::vector<std::uint8_t> data{};
  std::int64_t first_ns = -1;  ///< From the command to its first byte; -1: nothing came.
  std::int64_t begin = -1;     ///< The place of a response in `data`; -1: there is none.

  [[nodiscard]] bool is_response() const noexcept { return begin >= 0; }
  /// The content of the response.
  [[nodiscard]] bytes content() const noexcept;
  /// The content as a number, little-endian, of 1 or 4 bytes.
  [[nodiscard]] std::optional<std::int32_t> number() const noexcept;
  /// "a55a0100000004 02", at most 32 bytes.
  [[nodiscard]] std::string text() const;
};

/// The connection to a lidar like `which`, which must outlive it. *Single thread.*
class acceptance_link {
 public:
  acceptance_link(std::unique_ptr<transport> opened, std::function<bool()> is_cancelled,
                  const model& which)
      : which_(which),
        port_(opened.get()),
        monitor_(std::move(opened), std::move(is_cancelled), which) {}

  [[nodiscard]] link_monitor& monitor() noexcept { return monitor_; }
  [[nodiscard]] const link_monitor& monitor() const noexcept { return monitor_; }

  [[nodiscard]] raw_reply ask(std::uint8_t code, std::int64_t patience_ns = 400 * ms);
  void send(command code) { monitor_.send(code); }
  /// Waits for a packet; how long it took, or -1.
  [[nodiscard]] std::int64_t wait_for_packet(std::int64_t patience_ns);
  /// Waits until nothing has arrived for 150 ms; when the last byte came after now, or -1.
  [[nodiscard]] std::int64_t wait_for_silence(std::int64_t patience_ns);
  /// Waits until two measurements of half a second agree within 3 %, at most 12 s. Returns the scan frequency
  /// in Hz, or 0.
  [[nodiscard]] double wait_until_steady();
  /// Starts the motor, in the way of the model. How long the first packet took, or -1.
  std::int64_t start();
  void stop();
  [[nodiscard]] bool is_two_way() const noexcept { return which_.link == link_kind::two_way; }
  /// Sets the line; false if there is none.
  bool set_dtr(bool high);
  /// A scan of this length.
  [[nodiscard]] stream_survey survey(std::int64_t time_ns);
  /// The same for its rates: a short one in which the stream pauses, as where the host is busy, is repeated.
  [[nodiscard]] stream_survey steady_survey(std::int64_t time_ns);
  /// Changes the frequency by `code` until it does not change any more; the last reply.
  [[nodiscard]] std::optional<std::int32_t> go_to_limit(std::uint8_t code);

 private:
  const model& which_;
  transport* port_;
  link_monitor monitor_;  // owns the transport
};

}  // namespace g4lidar
