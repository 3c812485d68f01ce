// SPDX-License-Identifier: MIT
// The connection to a lidar that is examined. Commands are sent as they are, and replies kept as bytes: the session
// of the library would hide what is to be found out.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "g4lidar/core/command.hpp"
#include "g4lidar/core/layout_recogniser.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/transport/transport.hpp"
#include "kit.hpp"
#include "survey.hpp"

namespace g4_tool::acceptance {

/// After this time of a scan the motor turns steadily.
inline constexpr std::int64_t spun_up_ns = 3'000 * ms;
/// After this time without a scan it stands.
inline constexpr std::int64_t run_down_ns = 3'000 * ms;
/// A survey of at most this length gives no rates if it is not steady.
inline constexpr std::int64_t short_survey_ns = 5'000 * ms;
inline constexpr std::string_view not_steady =
    "The packets came irregularly: this computer was too busy to measure the rates.";

[[nodiscard]] constexpr double in_ms(std::int64_t ns) noexcept {
  return static_cast<double>(ns) / 1e6;
}

/// The bytes that came after a command.
struct raw_reply {
  std::vector<std::uint8_t> data{};
  std::int64_t first_ns = -1;  ///< From the command to its first byte; -1: nothing came.
  std::int64_t begin = -1;     ///< The place of a response in `data`; -1: there is none.

  [[nodiscard]] bool is_response() const noexcept { return begin >= 0; }
  /// All bytes behind the header of the response.
  [[nodiscard]] bytes content() const noexcept;
  /// How many there are, or how many the header states if that is not `expected`.
  [[nodiscard]] std::size_t length(std::size_t expected) const noexcept;
  /// The content as a number, little-endian, of 1 or 4 bytes.
  [[nodiscard]] std::optional<std::int32_t> number() const noexcept;
  /// "a55a010000000402", at most 32 bytes.
  [[nodiscard]] std::string text() const;
};

/// When a motor began to turn steadily.
struct steady_motor {
  double hz = 0.0;  ///< 0: it did not within 12 s.
  std::int64_t since_ns = 0;
};

/// *Single thread.* After a loss or a cancellation nothing arrives, and every call returns immediately.
class lidar_link {
 public:
  lidar_link(std::unique_ptr<transport> opened, std::function<bool()> is_cancelled,
             const model& model)
      : port_(std::move(opened)), is_cancelled_(std::move(is_cancelled)) {
    read_as(model);
  }

  using observer = std::function<void(const event&, std::int64_t arrival_ns)>;
  /// Observes until `until_ns`, which the observer may change.
  void listen(const std::int64_t& until_ns, const observer& to = {});
  void listen_for(std::int64_t time_ns) { listen(now_ns() + time_ns); }
  /// Packets are those of a lidar like `model` from now on, which is copied.
  void read_as(const model& model);

  void send(command code);
  /// Sends a command, and waits for its reply.
  [[nodiscard]] raw_reply ask(command code, std::int64_t patience_ns = 400 * ms);
  /// The number that answers a query that changes nothing: asked again where no answer comes.
  [[nodiscard]] std::optional<std::int32_t> number(command query);
  /// Waits for a packet; how long it took, or -1.
  [[nodiscard]] std::int64_t wait_for_packet(std::int64_t patience_ns);
  /// Waits until nothing has arrived for 150 ms; when the last byte came after now, or -1.
  [[nodiscard]] std::int64_t wait_for_silence(std::int64_t patience_ns);
  /// Starts the motor, in the way of the model. How long the first packet took, or -1.
  std::int64_t start();
  /// Stops the scan. Returns whether a two-way lidar is silent.
  bool stop_scan();
  /// The same, and lowers the line DTR that drives the motor.
  bool stop();
  /// Sets the line DTR; false if there is none.
  bool set_dtr(bool high);
  /// A scan of this length.
  [[nodiscard]] packet_survey survey(std::int64_t time_ns);

  [[nodiscard]] transport& port() noexcept { return *port_; }
  [[nodiscard]] std::int64_t now_ns() const noexcept { return port_->now_ns(); }
  [[nodiscard]] bool is_two_way() const noexcept { return which_.link == link_kind::two_way; }
  [[nodiscard]] const stream_counts& counts() const noexcept { return counts_; }
  /// Texts of at least 16 letters: lidars send one when they boot.
  [[nodiscard]] std::uint64_t boots() const noexcept { return boots_; }
  /// The size of a sample, whatever the model; 0: not known.
  [[nodiscard]] std::size_t sample_bytes() const noexcept { return layout_.sample_bytes(); }
  [[nodiscard]] const std::optional<error>& failure() const noexcept { return error_; }
  [[nodiscard]] bool is_over() const noexcept { return is_cancelled_now_ || error_; }
  /// From now on the run cannot be cancelled: the lidar is to be left as it was.
  void ignore_cancel() noexcept {
    is_cancelled_ = nullptr;
    is_cancelled_now_ = false;
  }

 private:
  void take(bytes data, std::int64_t arrival_ns, const observer& to);
  void give(const event& found, std::int64_t arrival_ns, const observer& to);
  void look_for_text(bytes noise);

  std::unique_ptr<transport> port_;
  std::function<bool()> is_cancelled_;
  model which_ = g4_model;
  stream_parser parser_;
  layout_recogniser layout_;
  stream_counter counts_;
  std::vector<std::uint8_t> raw_{};  // the bytes of the events that are still to come
  std::function<void(bytes, std::int64_t)> on_bytes_{};
  std::array<std::uint8_t, 4096> buffer_{};
  std::int64_t heard_ns_ = 0;
  std::size_t letters_ = 0;  // consecutive
  std::uint64_t boots_ = 0;
  std::optional<error> error_{};
  bool is_cancelled_now_ = false;
};

/// Lowers DTR for this time, which stops a motor that it drives, and raises it. False if there is none.
bool pulse_dtr(lidar_link& link, std::int64_t low_ns = 120 * ms);
/// Waits until four revolutions and a second have the same speed within 3 %, at most 12 s.
[[nodiscard]] steady_motor wait_until_steady(lidar_link& link);
/// A survey for its rates: a short one that is not steady is repeated, twice.
[[nodiscard]] packet_survey steady_survey(lidar_link& link, std::int64_t time_ns);

}  // namespace g4_tool::acceptance
