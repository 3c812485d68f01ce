// SPDX-License-Identifier: MIT
// What has become of a stream of packets on its way: which bytes were changed, lost or added, how
// evenly they came, and how fast the head turns. Constant memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "doctor_ear.hpp"
#include "doctor_words.hpp"
#include "g4lidar/packet.hpp"
#include "g4lidar/stream_counts.hpp"

namespace g4_dump {

/// Stretches between two good packets in which something was not as sent, by what their length and
/// their checksum tell. A stretch is judged where it is known how many bytes it ought to have had:
/// not around the begin of a revolution, where packets of unknown length stand.
struct damage_counts {
  std::uint64_t changed = 0;  ///< The right length.
  std::uint64_t changed_packets = 0;
  std::uint64_t one_packet = 0;  ///< Of those, a single packet, whose checksum can be looked at:
  std::uint64_t wrong_bits = 0;  ///< so many bits of the checksums were wrong, all together.
  std::uint64_t shortened = 0;   ///< Up to five bytes a packet too short.
  std::uint64_t cut = 0;         ///< More than that too short.
  std::uint64_t lengthened = 0;  ///< Too long.
  std::uint64_t vanished = 0;    ///< Packets of which not a byte came.
  std::uint64_t unclear = 0;

  [[nodiscard]] std::uint64_t all() const noexcept {
    return changed + shortened + cut + lengthened + vanished + unclear;
  }
};

class stream_watch {
 public:
  void take(const heard& came);
  void take(const batch& came);

  /// The head is up to speed: from now on packets are judged, and everything is counted anew.
  void begin(std::int64_t now_ns);
  /// What comes next does not follow on what came.
  void part() noexcept;

  // While it spins up.
  /// Degrees from sample to sample, the median of the last packets; nothing while there are few.
  [[nodiscard]] std::optional<double> step_deg() const;

  // Since begin().
  [[nodiscard]] const g4lidar::stream_counts& counts() const noexcept { return counts_; }
  [[nodiscard]] const damage_counts& damage() const noexcept { return damage_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
  [[nodiscard]] std::uint64_t samples_lost() const noexcept { return lost_; }
  /// Packets in which the head goes back, or goes nowhere near as far as in others.
  [[nodiscard]] std::uint64_t jerks() const noexcept { return jerks_; }
  /// Samples measured in a second, by the arrivals; 0 where too little came.
  [[nodiscard]] double sample_rate_hz() const noexcept;
  /// Revolutions in a second, by the angles and the arrivals.
  [[nodiscard]] double frequency_hz() const noexcept;
  /// The same by what zero packets say, the mean; 0 where none does.
  [[nodiscard]] double reported_hz() const noexcept;
  /// The most samples that came in one packet.
  [[nodiscard]] std::size_t packet_samples() const noexcept;
  /// Times in which nothing came, though somebody listened, longer than `stall_ns`.
  [[nodiscard]] std::uint64_t stalls() const noexcept { return stalls_; }
  [[nodiscard]] std::int64_t longest_silence_ns() const noexcept { return longest_silence_ns_; }
  /// How long a byte was held back before it was handed over, at least: half of them longer.
  [[nodiscard]] double held_back_ms(std::uint32_t baud) const noexcept;
  /// That have come and belong to none.
  [[nodiscard]] std::uint64_t bytes_since_packet() const noexcept { return since_packet_; }
  /// So many that it is no mere damage: a third of a second of them.
  [[nodiscard]] bool has_become_garbage() const noexcept { return since_packet_ > 6'000; }
  [[nodiscard]] std::int64_t last_packet_ns() const noexcept { return last_packet_ns_; }

  static constexpr std::int64_t stall_ns = 150'000'000;

 private:
  /// What is needed of the last good packet.
  struct place {
    std::int64_t arrival_ns;
    double last_deg;
    double first_deg;
    std::size_t samples;
  };
  void take_packet(g4lidar::packet_view packet, std::int64_t arrival_ns);
  [[nodiscard]] bool is_jerk(g4lidar::packet_view packet) const;
  void learn_step(const place& before, const place& now);
  void judge(const place& before, const place& now, bool is_zero);
  void judge_bytes(std::size_t lost_packets);
  void measure_pace(const place& before, const place& now, double missing);

  g4lidar::stream_counts counts_;
  damage_counts damage_;
  bool judging_ = false;
  bool stalled_here_ = false;    // since the last good packet
  std::int64_t backlog_ns_ = 0;  // until then what was held up comes, as far as it was kept
  std::uint64_t bytes_ = 0;
  std::uint64_t samples_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t jerks_ = 0;
  std::array<std::uint64_t, g4lidar::max_samples + 1> sizes_{};
  std::optional<place> last_;
  std::optional<double> zero_deg_;
  std::vector<std::uint8_t> between_;  // bytes since the last good packet; at most max_between
  std::size_t between_size_ = 0;
  bool between_answers_ = false;
  std::array<double, 31> steps_{};
  std::size_t step_count_ = 0;
  double pace_samples_ = 0.0;  // over stretches without a pause
  double pace_deg_ = 0.0;
  std::int64_t pace_ns_ = 0;
  std::uint64_t reported_dhz_ = 0;
  std::uint64_t reports_ = 0;
  std::array<std::uint64_t, 512> batch_bytes_{};  // bytes that came in batches of this size
  std::uint64_t stalls_ = 0;
  std::int64_t longest_silence_ns_ = 0;
  std::int64_t last_packet_ns_ = 0;
  std::uint64_t since_packet_ = 0;  // bytes
};

/// Whether what was changed was changed in stretches, and not in single bits here and there.
[[nodiscard]] bool comes_in_bursts(const damage_counts& damage, std::uint64_t good_packets);

/// The diagnoses of a damaged stream, the one with most events first; more only where they have a
/// good share.
[[nodiscard]] std::vector<diagnosis> diagnoses_of(const stream_watch& watched);

}  // namespace g4_dump
