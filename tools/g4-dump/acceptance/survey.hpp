// SPDX-License-Identifier: MIT
// What the packets of a scan contain, as counts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "g4lidar/core/ct_information.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"

namespace g4_tool::acceptance {

using namespace g4lidar;

/// Ranges by direction: one degree each, clockwise in the frame of the device. *Single thread.*
class direction_survey {
 public:
  explicit direction_survey(const model& model) : decoder_(model) {}

  void take(packet_view packet);
  /// The median of the ranges in this direction, of at least five; nothing if there are fewer.
  [[nodiscard]] std::optional<double> range_mm(std::size_t degree) const;
  /// The middle of the directions of the nearest target, and the direction with the longest range_mm().
  [[nodiscard]] std::optional<std::size_t> nearest() const;
  [[nodiscard]] std::optional<std::size_t> farthest() const;

 private:
  bulk_decoder decoder_;
  std::array<std::vector<float>, 360> ranges_;
};

/// *Single thread.*
class packet_survey {
 public:
  /// Samples by their range.
  enum zone : std::uint8_t { no_return, below_1_m, below_2_m, beyond };
  static constexpr std::size_t zones = 4;

  explicit packet_survey(const model& model) : directions(model), layout_(model.samples.layout) {}

  void take(const event& found, std::int64_t arrival_ns);

  /// Measured from the first zero packet to the last; 0 with fewer than two.
  [[nodiscard]] double frequency_hz() const noexcept { return per_second(zero_packets - 1); }
  [[nodiscard]] double sample_rate_hz() const noexcept {
    return zeros_.empty() ? 0.0 : per_second(zeros_.back().samples);
  }
  /// The mean of what zero packets report, as they report it; 0: nothing.
  [[nodiscard]] double reported_hz() const noexcept;
  [[nodiscard]] const std::optional<g4lidar::ct_information>& information() const noexcept {
    return reader_.last();
  }

  /// Whether the packets came as they were measured, within 2 % of the time: not where the host was busy, and read
  /// late what had waited, or has lost some of it. Else rates and losses are not those of the lidar.
  [[nodiscard]] bool is_steady() const;

  direction_survey directions;
  stream_counter counts;
  std::uint64_t zero_packets = 0;
  std::uint64_t bad_checksums = 0;
  std::size_t most_samples = 0;
  /// How many samples of a zone have each value of the two lower bits.
  std::array<std::array<std::uint64_t, 4>, zones> bits{};
  /// Neighbours with a return whose two lower bits differ by 1 and whose byte of intensity shows what these
  /// bits are: it goes on where they are flags; it overflows where they are its upper bits.
  std::uint64_t smooth_changes = 0;
  std::uint64_t overflows = 0;
  std::uint64_t crc_fits =
      0;  ///< Revolutions with a byte behind them that is their CRC, or is not.
  std::uint64_t crc_misfits = 0;

 private:
  [[nodiscard]] double per_second(std::uint64_t count) const noexcept;
  void take(packet_view packet, std::int64_t arrival_ns);
  void compare_intensities(packet_view packet);

  sample_layout layout_;
  /// A zero packet: when it came, and the samples since the first one.
  struct arrival {
    std::int64_t time_ns;
    std::uint64_t samples;
  };
  std::vector<arrival> zeros_;
  std::uint64_t samples_ = 0;       // since the first zero packet
  std::uint64_t reported_chz_ = 0;  // the sum
  ct_revolution revolution_;
  ct_information_reader reader_;
};

}  // namespace g4_tool::acceptance
