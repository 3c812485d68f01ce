// SPDX-License-Identifier: MIT
// A device behind a transport: its bytes as events, and the session with it. Below the driver, the probe and the doctor.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "event_reader.hpp"
#include "g4lidar/core/session.hpp"
#include "g4lidar/transport/transport.hpp"
#include "transport/tcp_port.hpp"

namespace g4lidar {

/// *Single thread, never allocates.* The session of a one-way lidar has nothing to do.
class device_link {
 public:
  /// A device that has been silent for this time will not continue an unfinished packet. Bridges hold
  /// bytes back for up to 16 ms.
  static constexpr std::int64_t usual_cut_off_ns = 30'000'000;
  /// Through a network bridge it is so many times as long: TCP holds the second part of an answer back for 40 ms (Nagle's
  /// algorithm, and an acknowledgement that is delayed), and a wireless link for longer.
  static constexpr std::int64_t network_factor = 8;

  /// `input` parses the bytes of `port`, which may be null before follow(). Both must outlive this. `listens`: nothing is
  /// sent, as to a one-way lidar.
  explicit device_link(event_reader& input, transport* port, const session_times& times = {},
                       std::int64_t cut_off_after_ns = usual_cut_off_ns,
                       const model& model = g4_model, bool listens = false) noexcept
      : input_(input),
        on_(port),
        session_(times, model),
        cut_off_after_ns_(cut_off_after_ns),
        listens_(listens || model.link == link_kind::one_way),
        is_bridged_(port != nullptr && is_bridge(port->name())) {}

  /// Another transport: nothing is known about the device.
  void follow(transport& on) noexcept {
    on_ = &on;
    is_bridged_ = is_bridge(on.name());
    session_.reset();
    heard_ns_ = on.now_ns();
  }
  void set_cut_off_after(std::int64_t pause_ns) noexcept { cut_off_after_ns_ = pause_ns; }
  [[nodiscard]] session& talk() noexcept { return session_; }
  [[nodiscard]] const session& talk() const noexcept { return session_; }
  /// Whether nothing is sent to the device.
  [[nodiscard]] bool listens() const noexcept { return listens_; }
  /// Whether more than the packets of a wanted scan may come. Those are not cut off.
  [[nodiscard]] bool awaits_answer() const noexcept {
    return !listens_ && (session_.is_busy() || !session_.is_scanning());
  }

  /// One read into `buffer`, by `read(transport)`. Only after all events of the last one.
  template <class Read>
  [[nodiscard]] result<received> receive(bytes buffer, Read read) {
    result<received> got = read(*on_);
    if (got && got->count > 0) {
      heard_ns_ = got->arrival_ns;
      input_.feed(buffer.first(got->count), heard_ns_);
    }
    return got;
  }
  /// One read until the deadline, then cut_off().
  [[nodiscard]] result<received> receive(std::span<std::uint8_t> buffer, std::int64_t deadline_ns) {
    auto got = receive(buffer, [&](transport& on) { return on.read(buffer, deadline_ns); });
    if (got && got->count == 0) static_cast<void>(cut_off());
    return got;
  }
  /// When the last byte arrived.
  [[nodiscard]] std::int64_t heard_ns() const noexcept { return heard_ns_; }
  /// The device does not continue a packet after such a pause: events() parses the held bytes again, before the
  /// next answer is taken for the rest of the packet. Returns whether it is so.
  [[nodiscard]] bool cut_off() noexcept {
    const std::int64_t end_ns = cut_off_ns();
    const bool is_due = end_ns != never_ns && on_->now_ns() >= end_ns;
    if (is_due) input_.cut();
    return is_due;
  }
  /// When cut_off() or session::look() is due, if nothing arrives.
  [[nodiscard]] std::int64_t due_ns() const noexcept {
    return std::min(session_.next_look_ns(), cut_off_ns());
  }

  /// Passes each event that `next()` returns to the session, then to `sink`, until it returns nothing. Inlined:
  /// a call costs 20 instructions for each packet.
  template <class Next, class Sink>
  [[gnu::always_inline]] void events(Next next, Sink sink) {
    while (const event* const found = next()) {
      if (!listens_) session_.take(*found, heard_ns_);
      sink(*found);
    }
  }
  /// The same for all events.
  void events(auto sink) {
    events([this] { return input_.next(); }, sink);
  }
  /// Nothing follows: the same for the held bytes.
  void finish(auto sink) {
    input_.cut();
    events(sink);
  }
  /// Sends the commands of the session: calls `write(bytes)` for each, until one fails.
  [[nodiscard]] result<void> send(auto write) {
    while (const auto command = session_.to_send()) {
      if (result<void> sent = write(bytes(*command)); !sent) return sent;
    }
    return {};
  }

 private:
  [[nodiscard]] std::int64_t cut_off_ns() const noexcept {
    if (input_.held() == 0 || !awaits_answer()) return never_ns;
    return heard_ns_ + cut_off_after_ns_ * (is_bridged_ ? network_factor : 1);
  }

  event_reader& input_;
  transport* on_;
  session session_;
  std::int64_t cut_off_after_ns_;
  std::int64_t heard_ns_ = 0;
  bool listens_;
  bool is_bridged_;
};

}  // namespace g4lidar
