// SPDX-License-Identifier: MIT
// What the packets of a scan contain, as counts: for the acceptance of a model.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "g4lidar/bulk_decoder.hpp"
#include "g4lidar/core/ct_check.hpp"
#include "g4lidar/core/ct_information.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_counter.hpp"

namespace g4lidar {

/// Ranges by direction: one degree each, clockwise in the frame of the device. *Single thread.*
class direction_survey {
 public:
  explicit direction_survey(const model& which) : decoder_(which) {}

  void take(packet_view packet);
  /// The median of the ranges in this direction, of at least five; nothing if there are fewer.
  [[nodiscard]] std::optional<double> range_mm(std::size_t degree) const;
  /// The direction with the shortest range_mm().
  [[nodiscard]] std::optional<std::size_t> nearest() const;

 private:
  bulk_decoder decoder_;
  std::array<std::vector<float>, 360> ranges_;
};

/// *Single thread.*
class stream_survey {
 public:
  /// Samples by their range.
  enum zone : std::uint8_t { no_return, below_1_m, below_2_m, beyond };
  static constexpr std::size_t zones = 4;

  explicit stream_survey(const model& which) : which_(which) {}

  void take(const event& found, std::int64_t arrival_ns);

  [[nodiscard]] const stream_counts& counts() const noexcept { return counts_; }
  [[nodiscard]] std::uint64_t zero_packets() const noexcept { return zero_packets_; }
  /// The longest time between two packets.
  [[nodiscard]] std::int64_t longest_gap_ns() const noexcept { return longest_gap_ns_; }
  [[nodiscard]] std::uint64_t bad_checksums() const noexcept { return bad_checksums_; }
  [[nodiscard]] std::size_t most_samples() const noexcept { return most_samples_; }
  [[nodiscard]] std::uint64_t samples() const noexcept {
    std::uint64_t all = 0;
    for (const auto& where : bits_) {
      for (const std::uint64_t count : where) all += count;
    }
    return all;
  }
  /// Measured from the first zero packet to the last; 0 with fewer than two.
  [[nodiscard]] double frequency_hz() const noexcept { return per_second(zero_packets_ - 1); }
  [[nodiscard]] double sample_rate_hz() const noexcept { return per_second(samples_at_zero_); }
  /// The mean of what zero packets report, as they report it; 0: nothing.
  [[nodiscard]] double reported_hz() const noexcept;
  /// How many samples of the zone have these two lower bits.
  [[nodiscard]] std::uint64_t bits(zone where, unsigned value) const noexcept {
    return bits_.at(where).at(value);
  }
  /// Neighbours with a return whose two lower bits differ by 1 and whose byte of intensity shows what these
  /// bits are: it goes on where they are flags; it overflows where they are its upper bits.
  [[nodiscard]] std::uint64_t smooth_changes() const noexcept { return changes_[0]; }
  /// See smooth_changes().
  [[nodiscard]] std::uint64_t overflows() const noexcept { return changes_[1]; }
  /// Revolutions whose CRC byte fits, and does not.
  [[nodiscard]] std::uint64_t crc_fits() const noexcept { return crc_[1]; }
  [[nodiscard]] std::uint64_t crc_misfits() const noexcept { return crc_[0]; }
  [[nodiscard]] const std::optional<ct_information>& information() const noexcept {
    return reader_.last();
  }
  /// Packets other than zero packets with other bits than 0 in CT.
  [[nodiscard]] std::uint64_t informing_packets() const noexcept { return informing_; }

 private:
  [[nodiscard]] double per_second(std::uint64_t count) const noexcept;
  void take(packet_view packet, std::int64_t arrival_ns);
  void compare_intensities(packet_view packet);

  const model& which_;
  stream_counter counts_;
  std::uint64_t zero_packets_ = 0;
  std::uint64_t bad_checksums_ = 0;
  std::uint64_t informing_ = 0;
  std::size_t most_samples_ = 0;
  std::int64_t first_zero_ns_ = 0;
  std::int64_t last_zero_ns_ = 0;
  std::int64_t last_packet_ns_ = 0;
  std::int64_t longest_gap_ns_ = 0;
  std::uint64_t samples_ = 0;          // since the first zero packet
  std::uint64_t samples_at_zero_ = 0;  // before the last one
  std::uint64_t reported_dhz_ = 0;     // the sum
  std::array<std::array<std::uint64_t, 4>, zones> bits_{};
  std::array<std::uint64_t, 2> changes_{};
  std::array<std::uint64_t, 2> crc_{};
  ct_revolution revolution_;
  ct_information_reader reader_;
};

}  // namespace g4lidar
