// SPDX-License-Identifier: MIT
// The counts of a stretch of a stream: damage, arrivals, sample rate. Those of two stretches can be added.
// Constant memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "g4lidar/core/clock/arrival_window.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "link_monitor.hpp"
#include "survey/return_map.hpp"

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
  void add(const damage_counts& other) noexcept;
};

/// The sizes of reads, and the times without bytes.
class arrival_statistics {
 public:
  void take(const timed_read& observed);
  void add(const arrival_statistics& other) noexcept;
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// Times longer than `stall_ns` without bytes, although the program was waiting.
  [[nodiscard]] std::uint64_t stalls() const noexcept { return stalls_; }
  [[nodiscard]] std::int64_t longest_silence_ns() const noexcept { return longest_silence_ns_; }
  /// The longest time for which the program was suspended.
  [[nodiscard]] std::int64_t longest_host_pause_ns() const noexcept { return longest_pause_ns_; }
  /// Whether there were reads that waited for their bytes.
  [[nodiscard]] bool has_delays() const noexcept { return portioned_ > 0; }
  /// The delay of a byte before its delivery, at least: half of the bytes have a longer one.
  [[nodiscard]] double held_back_ms(std::uint32_t baud) const noexcept;

  static constexpr std::int64_t stall_ns = 150'000'000;

 private:
  std::uint64_t bytes_ = 0;
  std::array<std::uint64_t, 512> portions_{};  // bytes that arrived in reads of this size
  std::uint64_t portioned_ = 0;                // their sum
  std::uint64_t stalls_ = 0;
  std::int64_t longest_silence_ns_ = 0;
  std::int64_t longest_pause_ns_ = 0;
};

/// The sample rate from counts and arrivals, which are late but never early: a pause of the host,
/// or a bridge that holds bytes back, makes some arrivals late and does not change the others.
class sample_pace {
 public:
  /// Of samples like those of `model`: the window needs their rate within a half.
  explicit sample_pace(const model& model = g4_model) noexcept
      : nominal_ns_(1e9 / first_rate_hz(model)) {
    window_.clear();
  }

  /// The number of further samples that had arrived by then.
  void add(std::size_t samples, std::int64_t arrival_ns) noexcept;
  /// An unknown number of samples is missing here.
  void part() noexcept;
  /// Whether the next arrival begins a line.
  [[nodiscard]] bool is_empty() const noexcept { return window_.span_ns() == 0; }
  /// Adds another stretch, which has ended with part().
  void add(const sample_pace& parted) noexcept;
  /// Samples per second; 0 if there is not enough data.
  [[nodiscard]] double rate_hz() const noexcept;

 private:
  double nominal_ns_;
  arrival_window window_{nominal_ns_};
  double period_ns_ = nominal_ns_;
  unsigned blocks_ = 0;
  std::int64_t samples_ = 0;
  double parted_samples_ = 0.0;  // before the last part()
  double parted_ns_ = 0.0;
};

/// Everything that is counted in a stretch of a stream: the sums of two stretches are those of both.
struct stream_tally {
  struct mean {
    double sum = 0.0;
    double count = 0.0;
    [[nodiscard]] double get() const noexcept { return count > 0.0 ? sum / count : 0.0; }
    void add(const mean& other) noexcept {
      sum += other.sum;
      count += other.count;
    }
  };
  stream_counter counts{};
  damage_counts damage{};
  arrival_statistics arrivals{};
  sample_pace pace{};
  return_map returns{};
  std::uint64_t samples = 0;
  std::uint64_t lost = 0;
  std::uint64_t jerks = 0;  // packets in which the head moves back, or much less far than in others
  mean turned{};            // degrees
  mean reported{};          // 0.01 Hz
  std::uint64_t checks = 0;    // of the speed of the head
  std::uint64_t unsteady = 0;  // those that found that it changes

  /// Adds another stretch, whose pace has ended with part().
  void add(const stream_tally& other) noexcept;

  /// Samples per second by the arrivals; 0 if there is not enough data.
  [[nodiscard]] double sample_rate_hz() const { return pace.rate_hz(); }
  /// The turn of the head per sample, as a fraction of a revolution, on average; 0 if it is not
  /// known.
  [[nodiscard]] double turns_per_sample() const noexcept { return turned.get() / 360.0; }
  /// Revolutions per second, by the angles and the sample rate.
  [[nodiscard]] double frequency_hz() const { return turns_per_sample() * sample_rate_hz(); }
  /// The mean frequency in zero packets; 0 if none has one.
  [[nodiscard]] double reported_chz() const noexcept { return reported.get(); }
};

}  // namespace g4lidar
