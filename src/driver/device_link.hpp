// SPDX-License-Identifier: MIT
// What a device sends, as events, and the session with it: below the driver, the probe and the doctor.
#pragma once

#include <algorithm>
#include <cstdint>

#include "g4lidar/core/session.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// The end of packets and responses that do not continue, and the commands and times of a session.
/// *Single thread, never allocates.* The caller reads the transport, and takes the events.
class device_link {
 public:
  /// A device that has been silent for this time will not continue an unfinished packet. Bridges hold
  /// bytes back for up to 16 ms.
  static constexpr std::int64_t usual_cut_off_ns = 30'000'000;

  /// `parser` gets the bytes, and must outlive this.
  explicit device_link(const stream_parser& parser, const session_times& times = {},
                       std::int64_t cut_off_after_ns = usual_cut_off_ns,
                       const model& which = g4_model) noexcept
      : parser_(parser), session_(times, which), cut_off_after_ns_(cut_off_after_ns) {}

  /// Another transport follows: nothing is known about the device.
  void reset(std::int64_t now_ns) noexcept {
    session_.reset();
    heard_ns_ = now_ns;
  }
  void set_cut_off_after(std::int64_t pause_ns) noexcept { cut_off_after_ns_ = pause_ns; }
  [[nodiscard]] session& talk() noexcept { return session_; }
  [[nodiscard]] const session& talk() const noexcept { return session_; }

  /// Bytes have arrived, which the parser gets.
  void heard(std::int64_t arrival_ns) noexcept { heard_ns_ = arrival_ns; }
  /// When the last byte arrived.
  [[nodiscard]] std::int64_t heard_ns() const noexcept { return heard_ns_; }
  /// An event of the parser.
  void take(const event& found) noexcept { session_.take(found, heard_ns_); }

  /// The device does not continue a packet after such a pause. The held bytes are to be parsed again,
  /// before the next answer is taken for the rest of the packet.
  [[nodiscard]] bool is_cut_off(std::int64_t now_ns) const noexcept {
    return now_ns >= cut_off_ns();
  }
  /// When is_cut_off() becomes true, if nothing arrives.
  [[nodiscard]] std::int64_t cut_off_ns() const noexcept {
    return parser_.held() > 0 ? heard_ns_ + cut_off_after_ns_ : never_ns;
  }

  /// Sends the commands of the session: calls `write(bytes)` for each, until one fails.
  [[nodiscard]] result<void> send(auto write) {
    while (const auto command = session_.to_send()) {
      if (result<void> sent = write(bytes(*command)); !sent) return sent;
    }
    return {};
  }

 private:
  const stream_parser& parser_;
  session session_;
  std::int64_t cut_off_after_ns_;
  std::int64_t heard_ns_ = 0;
};

}  // namespace g4lidar
