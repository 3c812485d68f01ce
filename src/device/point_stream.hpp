// SPDX-License-Identifier: MIT
// From events of the parser to points in a ring and revolutions: the driver's products.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "../bulk_kernels.hpp"
#include "g4lidar/decode.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/scan.hpp"
#include "g4lidar/sensor_clock.hpp"
#include "g4lidar/stream_parser.hpp"

namespace g4lidar {

/// *Allocates on open.* Show it the events one after the other; behind each packet, take the scans.
class point_stream {
 public:
  point_stream(std::int64_t transport_delay_ns, bool partial_scans)
      : partial_scans_(partial_scans),
        transport_delay_ns_(transport_delay_ns),
        storage_(largest_scan),
        assembler_(storage_) {}

  /// What follows comes over another line, see transport::baud(). Before begin().
  void follow(std::uint32_t baud) noexcept {
    if (baud == baud_) return;  // the clock may go on
    baud_ = baud;
    byte_ns_ = baud == 0 ? 0 : 10'000'000'000 / baud;
    clock_ = sensor_clock({.transport_delay_ns = transport_delay_ns_, .baud = baud});
  }

  /// A scan begins, or goes on after a break. `samples_per_second` nominally.
  void begin(std::uint32_t samples_per_second) noexcept {
    end();
    scans_at_begin_ = scans_;
    clock_.reset(samples_per_second);
    last_packet_ns_ = 0;
  }

  /// The scan is over; what there is of a revolution is counted.
  void end() noexcept {
    if (const auto rest = assembler_.finish()) count(*rest);
  }

  /// Whether a whole revolution has come since begin().
  [[nodiscard]] bool has_begun() const noexcept { return scans_ > scans_at_begin_; }

  /// `behind` bytes that came behind it have been read together with it, by `read_ns`.
  void packet(packet_view found, std::int64_t read_ns, std::size_t behind) noexcept {
    const std::int64_t arrival_ns = read_ns - gathered_for_ns(found, behind);
    open_ = without_points(found, revolutions_.count(found));
    const packet_times times = clock_.stamp(open_, arrival_ns);
    if (!open_.suspect) {
      to_points_(found, open_.revolution, times, memory_);
      open_.points = std::span(memory_).first(found.sample_count());
    }
    ring_->push(open_.points);
    if (times.lost > 0) {
      samples_lost_ += static_cast<std::uint64_t>(times.lost);
      assembler_.lost();  // where whole packets are gone, no bytes were skipped
    }
    if (last_packet_ns_ != 0) {
      largest_gap_ns_ = std::max(largest_gap_ns_, arrival_ns - last_packet_ns_);
    }
    last_packet_ns_ = arrival_ns;
    is_open_ = true;
  }

  /// Bytes were skipped in the middle of the scan.
  void gone(skipped what) noexcept {
    assembler_.add(what);
    if (what.reason != skip_reason::noise) clock_.lost(what.count);
  }

  /// So many bytes of an unfinished frame have come. See sensor_clock::seen().
  void seen(std::size_t held, std::int64_t arrival_ns) noexcept { clock_.seen(held, arrival_ns); }

  /// The next scan of the packet last shown; it is good until the next call of anything here.
  [[nodiscard]] std::optional<scan> next_scan() noexcept {
    while (is_open_) {
      const auto found = assembler_.next(open_);
      if (!found) {
        is_open_ = false;
      } else if (count(*found) || partial_scans_) {
        return found;
      }
    }
    return std::nullopt;
  }
  /// Whether the packet last shown may hold more scans.
  [[nodiscard]] bool has_more() const noexcept { return is_open_; }

  /// From one sample to the next, as far as is known.
  [[nodiscard]] double period_ns() const noexcept { return 1e9 / clock_.sample_rate_hz(); }
  [[nodiscard]] lidar_ring& ring() noexcept { return *ring_; }
  [[nodiscard]] std::uint64_t scans() const noexcept { return scans_; }
  [[nodiscard]] std::uint64_t partial_scans() const noexcept { return partials_; }
  [[nodiscard]] std::uint64_t samples_lost() const noexcept { return samples_lost_; }
  [[nodiscard]] std::int64_t largest_gap_ns() const noexcept { return largest_gap_ns_; }

 private:
  /// 9 kHz at 5 Hz make 1,800 points; a motor that spins up makes more in one turn.
  static constexpr std::size_t largest_scan = 8192;
  /// What has gathered for longer has not been read in time.
  static constexpr std::int64_t longest_batch_ns = 50'000'000;

  /// For how long `behind` bytes have gathered behind a packet at least. They come one after the other,
  /// and not sooner than their samples are measured: for the first packet that is all there is to go by.
  /// Later the clock sees by itself that a program has slept, since packets are less and less late, but
  /// not if all look as if nearly in time.
  [[nodiscard]] std::int64_t gathered_for_ns(packet_view first, std::size_t behind) const noexcept {
    const auto line_ns = static_cast<std::int64_t>(behind) * byte_ns_;
    if (last_packet_ns_ != 0) return line_ns > longest_batch_ns ? line_ns / 2 : line_ns;
    const std::size_t count = std::min<std::size_t>(first.sample_count(), 40);
    const auto samples =
        static_cast<double>(behind * count) / static_cast<double>(packet_size(count));
    return std::max(line_ns, static_cast<std::int64_t>(0.95 * samples * period_ns()));
  }

  /// Counts a scan; true if it is a revolution from zero packet to zero packet, though points in it
  /// may have been lost.
  bool count(const scan& found) noexcept {
    constexpr scan_marks pieces =
        scan_marks::start_missing | scan_marks::end_missing | scan_marks::turn_short;
    const bool whole = !found.has(pieces);
    ++(whole ? scans_ : partials_);
    return whole;
  }

  bool partial_scans_;
  std::int64_t transport_delay_ns_;
  std::optional<std::uint32_t> baud_;  // of the line that it follows
  std::int64_t byte_ns_ = 0;           // that a byte takes on it
  decltype(bulk::kernels::to_timed_points) to_points_ =
      bulk::kernels_of(best_instruction_set()).to_timed_points;
  std::unique_ptr<lidar_ring> ring_ = std::make_unique<lidar_ring>();
  sensor_clock clock_;
  std::vector<point> storage_;
  scan_assembler assembler_;
  revolution_counter revolutions_;
  std::array<point, max_samples> memory_{};
  decoded open_{};
  bool is_open_ = false;
  std::int64_t last_packet_ns_ = 0;  // since begin()
  std::int64_t largest_gap_ns_ = 0;
  std::uint64_t samples_lost_ = 0;
  std::uint64_t scans_ = 0;
  std::uint64_t scans_at_begin_ = 0;
  std::uint64_t partials_ = 0;
};

}  // namespace g4lidar
