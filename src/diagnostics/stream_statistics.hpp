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
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/detail/arrival_window.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "link_monitor.hpp"

namespace g4lidar {

/// Damaged stretches between two valid packets, classified by their length and their checksum. A
/// stretch is evaluated if its expected number of bytes is known: not near the begin of a
/// revolution, where there are packets of unknown length.
struct damage_counts {
  std::uint64_t changed = 0;  ///< The right length.
  std::uint64_t changed_packets = 0;
  std::uint64_t one_packet = 0;  ///< Of those, a single packet, whose checksum can be examined:
  std::uint64_t wrong_bits = 0;  ///< the number of wrong bits in these checksums, in total.
  std::uint64_t shortened = 0;   ///< Up to five bytes a packet too short.
  std::uint64_t cut = 0;         ///< More than that too short.
  std::uint64_t lengthened = 0;  ///< Too long.
  std::uint64_t vanished = 0;    ///< Packets without a single received byte.
  std::uint64_t unclear = 0;

  [[nodiscard]] std::uint64_t all() const noexcept {
    return changed + shortened + cut + lengthened + vanished + unclear;
  }
};

/// The sizes of reads, and the times without bytes.
class arrival_statistics {
 public:
  void take(const reading& came);
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// Times longer than `stall_ns` without bytes, although the program was waiting.
  [[nodiscard]] std::uint64_t stalls() const noexcept { return stalls_; }
  [[nodiscard]] std::int64_t longest_silence_ns() const noexcept { return longest_silence_ns_; }
  /// The longest time for which the program was suspended.
  [[nodiscard]] std::int64_t longest_host_pause_ns() const noexcept { return longest_pause_ns_; }
  /// The delay of a byte before its delivery, at least: half of the bytes have a longer one.
  [[nodiscard]] double held_back_ms(std::uint32_t baud) const noexcept;

  static constexpr std::int64_t stall_ns = 150'000'000;

 private:
  std::uint64_t bytes_ = 0;
  std::array<std::uint64_t, 512> portions_{};  // bytes that arrived in reads of this size
  std::uint64_t stalls_ = 0;
  std::int64_t longest_silence_ns_ = 0;
  std::int64_t longest_pause_ns_ = 0;
};

/// The sample rate from counts and arrivals, which are late but never early: a pause of the host,
/// or a bridge that holds bytes back, makes some arrivals late and does not change the others.
class sample_pace {
 public:
  sample_pace() noexcept { window_.clear(); }

  /// The number of further samples that had arrived by then.
  void add(std::size_t samples, std::int64_t arrival_ns) noexcept;
  /// An unknown number of samples is missing here.
  void part() noexcept;
  /// Samples per second; 0 if there is not enough data.
  [[nodiscard]] double rate_hz() const noexcept;

 private:
  static constexpr double nominal_ns = 1e9 / 9000.0;

  arrival_window window_{nominal_ns};
  double period_ns_ = nominal_ns;
  std::int64_t samples_ = 0;
  double parted_samples_ = 0.0;  // before the last part()
  double parted_ns_ = 0.0;
};

/// Degrees from sample to sample: the median of the last packets.
class step_median {
 public:
  void add(double step_deg) noexcept { steps_[count_++ % steps_.size()] = step_deg; }
  /// Nothing if there are only a few.
  [[nodiscard]] std::optional<double> get() const;

 private:
  std::array<double, 31> steps_{};
  std::size_t count_ = 0;
};

class stream_statistics {
 public:
  void take(const observed_event& came);
  void take(const reading& came);

  /// The head has reached its speed: from now on packets are evaluated, and all counts begin again.
  void begin();
  /// The following bytes do not continue the previous ones.
  void part();
  /// The same, and packets are not evaluated until resume().
  void suspend();
  void resume();

  /// Degrees from sample to sample; nothing if there are few packets.
  [[nodiscard]] std::optional<double> step_deg() const { return steps_.get(); }
  /// Whether the head has reached its speed and keeps it: call it every 250 ms or 1,000 samples.
  [[nodiscard]] bool is_steady();

  // Since begin().
  [[nodiscard]] const stream_counts& counts() const noexcept { return counts_; }
  [[nodiscard]] const damage_counts& damage() const noexcept { return damage_; }
  [[nodiscard]] const arrival_statistics& arrivals() const noexcept { return arrivals_; }
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_; }
  [[nodiscard]] std::uint64_t samples_lost() const noexcept { return lost_; }
  /// Packets in which the head moves back, or much less far than in others.
  [[nodiscard]] std::uint64_t jerks() const noexcept { return jerks_; }
  /// Samples per second by the arrivals; 0 if there is not enough data.
  [[nodiscard]] double sample_rate_hz() const { return pace_.rate_hz(); }
  /// The turn of the head per sample, as a fraction of a revolution, on average; 0 if it is not
  /// known.
  [[nodiscard]] double turns_per_sample() const noexcept { return turned_.get() / 360.0; }
  /// Revolutions per second, by the angles and the sample rate.
  [[nodiscard]] double frequency_hz() const { return turns_per_sample() * sample_rate_hz(); }
  /// The mean frequency in zero packets; 0 if none has one.
  [[nodiscard]] double reported_hz() const noexcept { return reported_.get() / 10.0; }
  /// Bytes that have arrived and belong to no packet.
  [[nodiscard]] std::uint64_t bytes_since_packet() const noexcept { return since_packet_; }
  /// Whether there are more than by damage: a third of a second of them.
  [[nodiscard]] bool has_become_garbage() const noexcept { return since_packet_ > 6'000; }
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
  struct mean {
    double sum = 0.0;
    double count = 0.0;
    [[nodiscard]] double get() const noexcept { return count > 0.0 ? sum / count : 0.0; }
  };
  void take_packet(packet_view packet, std::int64_t arrival_ns);
  [[nodiscard]] bool is_jerk(packet_view packet) const;
  void judge(const place& before, const place& now, bool is_zero);
  void judge_bytes(std::size_t lost_packets);
  void measure_pace(const place& before, const place& now, std::size_t missing);
  /// The most samples in one packet.
  [[nodiscard]] std::size_t packet_samples() const noexcept;

  stream_counter counts_;
  damage_counts damage_;
  arrival_statistics arrivals_;
  sample_pace pace_;
  step_median steps_;
  stretch between_;
  std::optional<place> last_;
  std::optional<double> zero_deg_;
  std::array<std::uint64_t, max_samples + 1> sizes_{};
  bool steady_ = false;
  bool judging_ = false;
  double step_before_ = 0.0;     // at the last is_steady()
  std::int64_t backlog_ns_ = 0;  // until then delayed bytes arrive, as far as they were stored
  std::uint64_t samples_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t jerks_ = 0;
  mean turned_;                     // degrees
  mean reported_;                   // 0.1 Hz
  std::uint64_t since_packet_ = 0;  // bytes
};

/// The diagnoses of a damaged stream, the one with most events first; others only with a
/// significant share.
[[nodiscard]] std::vector<diagnosis> diagnoses_of(const stream_statistics& measured);

}  // namespace g4lidar
