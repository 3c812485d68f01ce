// SPDX-License-Identifier: MIT
// Decodes packets to points with their times, flagged unlikely if the angles of the packet do not fit.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "core/bulk_kernels.hpp"
#include "core/sample_clock.hpp"
#include "g4lidar/core/clock/sample_counter.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/reply_watch.hpp"
#include "g4lidar/core/sensor_clock.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/filter/plausibility.hpp"

namespace g4lidar {

/// *Single thread, never allocates.*
class timed_decoder {
 public:
  explicit timed_decoder(std::int64_t transport_delay_ns, const model& model = g4_model) noexcept
      : transport_delay_ns_(transport_delay_ns) {
    become(model);
  }

  /// The following packets are of a lidar like `model`.
  void become(const model& model) noexcept {
    which_ = &model;
    shortest_mm_ = model.range.min_mm;
    to_points_ = bulk::kernels_of(best_instruction_set(), model.samples).to_points;
  }

  /// See become().
  [[nodiscard]] const model& like() const noexcept { return *which_; }

  /// The following bytes are from another transport; see transport::baud(). Before begin().
  void follow(std::uint32_t baud) noexcept {
    if (baud == baud_) return;  // the clock may continue
    baud_ = baud;
    byte_ns_ = baud == 0 ? 0 : 10'000'000'000 / baud;
    clock_ = sensor_clock({.transport_delay_ns = transport_delay_ns_,
                           .baud = baud,
                           .layout = which_->samples.layout});
  }
  /// Another model sends the bytes. Before follow().
  void forget_transport() noexcept { baud_.reset(); }
  /// The following bytes may be earlier ones. Before follow().
  void forget() noexcept {
    forget_transport();
    counted_.reset();
    counted_until_ns_ = std::numeric_limits<std::int64_t>::min();
  }
  /// What is added to each angle.
  [[nodiscard]] zero_offset& zero() noexcept { return zero_; }
  [[nodiscard]] const zero_offset& zero() const noexcept { return zero_; }
  /// Whether points lack the offset that their model has.
  [[nodiscard]] bool lacks_zero() const noexcept {
    return which_->zero_angle_divisor != 0 && !zero_.angle();
  }
  /// A scan begins, or continues after an interruption. `sample_rate_hz` is nominal, or with `counts_times` that at which
  /// the times are counted from the samples that came, as those of raw bytes.
  void begin(std::uint32_t sample_rate_hz, bool counts_times = false) noexcept {
    if (counted_) counted_until_ns_ = counted_ns();
    counted_hz_ = counts_times ? sample_rate_hz : 0;
    clock_.reset(expected_rate_of(*which_, sample_rate_hz));
    counted_.reset();
    gaps_.reset();
    has_skipped_ = false;
    angles_ = {};
    last_packet_ns_ = 0;
  }

  /// Writes the points of a packet to the front of `out`. `behind` bytes behind it were read in the
  /// same read, at `read_ns`. `lost` is set if samples were lost without skipped bytes.
  [[nodiscard]] decoded decode(packet_view packet, std::int64_t read_ns, std::size_t behind,
                               std::span<point, max_samples> out, bool& lost) noexcept {
    if (counted_hz_ > 0) [[unlikely]]
      return decode_counted(packet, read_ns, behind, out, lost);
    return decode_as<false>(packet, read_ns, behind, out, lost);
  }
  /// Bytes were skipped within the scan.
  void gone(skipped what) noexcept {
    angles_.lost();
    if (what.reason == skip_reason::noise) return;
    has_skipped_ = true;
    clock_.lost(what.count);
  }
  /// So many bytes of an unfinished packet have arrived. See sensor_clock::seen().
  void seen(std::size_t held, std::int64_t arrival_ns) noexcept { clock_.seen(held, arrival_ns); }

  /// The time from one sample to the next, as far as it is known.
  [[nodiscard]] double period_ns() const noexcept { return 1e9 / clock_.sample_rate_hz(); }
  /// When the sample after the last one is measured.
  [[nodiscard]] std::int64_t next_sample_ns() const noexcept { return clock_.next_sample_ns(); }
  /// When the last packet arrived; 0 if none has come since begin().
  [[nodiscard]] std::int64_t last_packet_ns() const noexcept { return last_packet_ns_; }
  [[nodiscard]] std::uint64_t samples_lost() const noexcept { return samples_lost_; }
  [[nodiscard]] std::int64_t largest_gap_ns() const noexcept { return largest_gap_ns_; }

 private:
  /// The path of live lidars stays free of it.
  [[gnu::noinline]] decoded decode_counted(packet_view packet, std::int64_t read_ns,
                                           std::size_t behind, std::span<point, max_samples> out,
                                           bool& lost) noexcept {
    return decode_as<true>(packet, read_ns, behind, out, lost);
  }
  template <bool IsCounted>
  [[nodiscard]] decoded decode_as(packet_view packet, std::int64_t read_ns, std::size_t behind,
                                  std::span<point, max_samples> out, bool& lost) noexcept {
    const std::int64_t arrival_ns =
        detail::saturating_sub(read_ns, gathered_for_ns(packet, behind));
    decoded found = without_points(packet, revolutions_.count(packet));
    packet_times times;
    if constexpr (IsCounted)
      times.lost = lost_before(found);
    else
      times = clock_.stamp(found, arrival_ns);
    const bool fits = angles_.fits(packet);
    if (times.lost > 0) angles_.lost();  // or the angles are wrong: the next packet decides
    if (!found.suspect) {
      to_points_(packet, found.revolution, shortest_mm_, times, out);
      found.points = out.first(packet.sample_count());
      zero_.add_to(out.first(packet.sample_count()));
      if (!fits) mark_unlikely(out.first(packet.sample_count()));
    }
    if constexpr (IsCounted) count(found, arrival_ns, out);
    samples_lost_ += static_cast<std::uint64_t>(times.lost);
    lost = times.lost > 0;
    if (last_packet_ns_ != 0) {
      largest_gap_ns_ =
          std::max(largest_gap_ns_, detail::saturating_sub(arrival_ns, last_packet_ns_));
    }
    last_packet_ns_ = arrival_ns;
    return found;
  }
  /// By the angles: without arrivals nothing else shows it. Devices lose whole packets: less than half of one is none.
  [[nodiscard]] std::int64_t lost_before(const decoded& found) noexcept {
    const sample_gap gap = gaps_.next(found, has_skipped_, 0.0);
    if (!found.suspect) has_skipped_ = false;
    if (found.sample_count > 1) usual_samples_ = found.sample_count;  // one: a zero packet
    return 2 * gap.lost < usual_samples_ ? 0 : gap.lost;
  }
  /// The time of the next sample; 0 before the first one.
  [[nodiscard]] std::int64_t counted_ns() const noexcept {
    return counted_ ? detail::wrapping_add(counted_from_ns_, counted_->now_ns()) : 0;
  }
  /// The samples of a suspect packet were measured, too. A packet arrives one period after its last sample.
  void count(const decoded& found, std::int64_t arrival_ns,
             std::span<point, max_samples> out) noexcept {
    if (!counted_ && found.suspect) return;
    if (!counted_) {
      sample_clock packet(counted_hz_);
      packet.tick(found.sample_count);
      // A pipe may be read faster than its samples were measured: times do not go back.
      counted_from_ns_ =
          std::max(detail::saturating_sub(arrival_ns, packet.now_ns()), counted_until_ns_);
      counted_.emplace(counted_hz_);
    }
    if (found.suspect) return counted_->tick(found.sample_count);
    for (point& each : out.first(found.points.size())) {
      each.time_ns = counted_ns();
      counted_->tick();
    }
  }

  /// Bytes that accumulated for longer were not read in time.
  static constexpr std::int64_t longest_batch_ns = 50'000'000;

  /// The least time for which `behind` bytes accumulated behind a packet. They arrive one after the
  /// other, and not before their samples are measured: for the first packet nothing else is known.
  /// Later the clock itself detects a suspended program, because packets become less and less late,
  /// but not if all packets appear to be nearly in time.
  [[nodiscard]] std::int64_t gathered_for_ns(packet_view first, std::size_t behind) const noexcept {
    const auto wire_ns = static_cast<std::int64_t>(behind) * byte_ns_;
    if (last_packet_ns_ != 0) return wire_ns > longest_batch_ns ? wire_ns / 2 : wire_ns;
    const std::size_t count = std::min<std::size_t>(first.sample_count(), 40);
    const auto samples = static_cast<double>(behind * count) /
                         static_cast<double>(packet_size(count, first.layout()));
    return std::max(wire_ns, static_cast<std::int64_t>(0.95 * samples * period_ns()));
  }

  std::int64_t transport_delay_ns_;
  const model* which_ = nullptr;
  std::uint16_t shortest_mm_ = 0;
  decltype(bulk::kernels::to_points) to_points_ = nullptr;
  std::optional<std::uint32_t> baud_;  // of its transport
  std::int64_t byte_ns_ = 0;           // the time of a byte
  zero_offset zero_;
  sensor_clock clock_;
  std::uint32_t counted_hz_ = 0;         // 0: clock_ has the times
  std::optional<sample_clock> counted_;  // from the first point on
  std::int64_t counted_from_ns_ = 0;
  std::int64_t counted_until_ns_ = std::numeric_limits<std::int64_t>::min();  // before begin()
  sample_counter gaps_;                                                       // of counted times
  bool has_skipped_ = false;        // bytes since the last packet
  std::int64_t usual_samples_ = 0;  // of a packet
  revolution_counter revolutions_;
  angle_check angles_;
  std::int64_t last_packet_ns_ = 0;  // since begin()
  std::int64_t largest_gap_ns_ = 0;
  std::uint64_t samples_lost_ = 0;
};

}  // namespace g4lidar
