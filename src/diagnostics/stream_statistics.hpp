// SPDX-License-Identifier: MIT
// The damage of a stream of packets: which bytes were changed, lost or added, how evenly they
// arrived, and how fast the head turns. Constant memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "link_monitor.hpp"
#include "stream_tally.hpp"

namespace g4lidar {

/// Degrees from sample to sample: the median of the last packets.
class step_median {
 public:
  void add(double step_deg) noexcept;
  /// Nothing if there are only a few.
  [[nodiscard]] std::optional<double> get() const;
  /// The same, up to seven packets old: much faster.
  [[nodiscard]] std::optional<double> recent() const noexcept { return recent_; }

 private:
  std::array<double, 31> steps_{};
  std::size_t count_ = 0;
  std::optional<double> recent_;
};

/// The bytes of a quarter of a second at the usual baud rate of `model`.
[[nodiscard]] constexpr std::uint64_t garbage_bytes(const model& model) noexcept {
  constexpr std::uint64_t bits_of_a_byte = 10;
  return model.bauds[0] / bits_of_a_byte / 4;
}

class stream_statistics {
 public:
  /// Of packets like those of `model`, which must be valid as long as this.
  /// `is_long`: it runs as long as the lidar, so that it looks at returns now and then only.
  explicit stream_statistics(const model& model = g4_model, bool is_long = false)
      : which_(&model), is_long_(is_long) {}

  void take(const observed_event& observed);
  void take(const timed_read& observed);

  /// The head has reached its speed: from now on packets are evaluated, and all counts begin again.
  void begin();
  /// All counts begin again; returns those so far.
  [[nodiscard]] stream_tally next_stretch();
  /// Adds the counts of an earlier stretch. The head is steady if it was in most of the checks, and turns.
  void add(const stream_tally& earlier);
  /// The following bytes do not continue the previous ones.
  void part();
  /// The same, and packets are not evaluated until resume().
  void suspend();
  void resume();

  /// Degrees from sample to sample; nothing if there are few packets.
  [[nodiscard]] std::optional<double> step_deg() const { return steps_.get(); }
  /// Whether the head has reached its speed and keeps it: call it every 250 ms or 1,000 samples.
  [[nodiscard]] bool is_steady();

  /// All counts since begin().
  [[nodiscard]] const stream_tally& tally() const noexcept { return tally_; }
  /// Bytes that have arrived and belong to no packet.
  [[nodiscard]] std::uint64_t bytes_since_packet() const noexcept { return since_packet_; }
  /// Whether there are more than by damage.
  [[nodiscard]] bool has_become_garbage() const noexcept {
    return since_packet_ > garbage_bytes(*which_);
  }
  /// Whether the head has reached its speed.
  [[nodiscard]] bool was_steady() const noexcept { return steady_; }
  /// Whether it does not turn, although it measures.
  [[nodiscard]] bool stands() const;

 private:
  /// The data of the last valid packet.
  struct place {
    std::int64_t arrival_ns;
    double last_deg;
    double first_deg;
    std::size_t samples;
  };
  /// The bytes since the last valid packet.
  struct stretch {
    std::vector<std::uint8_t> raw{};  // at most `max_between`
    std::size_t size = 0;
    bool has_answers = false;
    bool is_unsure = false;  // there was a stall or a pause: bytes may have been lost by it
  };
  void take_packet(packet_view packet, std::int64_t arrival_ns);
  [[nodiscard]] bool is_jerk(packet_view packet) const;
  void judge(const place& before, const place& now, bool is_zero);
  void judge_bytes(std::size_t lost_packets);
  void measure_pace(const place& before, const place& now, std::size_t missing);

  const model* which_;
  bool is_long_;
  stream_tally tally_{.pace = sample_pace(*which_), .returns = return_map(is_long_)};
  step_median steps_;
  stretch between_;
  std::optional<place> last_;
  std::optional<double> zero_deg_;
  std::array<std::uint64_t, max_samples + 1> sizes_{};
  std::size_t usual_size_ = 1;  // the number of samples in most packets, above 1 if there are any
  bool steady_ = false;
  bool judging_ = false;
  double step_before_ = 0.0;        // at the last is_steady()
  std::int64_t backlog_ns_ = 0;     // until then delayed bytes arrive, as far as they were stored
  std::uint64_t since_packet_ = 0;  // bytes
};

/// The diagnoses of a damaged stream, the one with most events first; others only with a
/// significant share.
[[nodiscard]] std::vector<diagnosis> diagnoses_of(const stream_statistics& measured);

}  // namespace g4lidar
