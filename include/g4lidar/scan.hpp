// SPDX-License-Identifier: MIT
// Revolutions: points cut at the zero packets, in the caller's storage.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "g4lidar/decode.hpp"
#include "g4lidar/packet.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/stream_parser.hpp"

namespace g4lidar {

/// Why a scan is not one whole revolution; a set of bits.
enum class scan_marks : std::uint8_t {
  none = 0,
  start_missing = 1,  ///< Does not begin with a zero packet: the first scan, or one after a cut.
  end_missing = 2,    ///< Was cut before its zero packet came, or the stream ended.
  data_lost = 4,      ///< Bytes were lost, or a suspect packet left out, between its points.
  turn_short = 8,     ///< Its two zero packets came well before the angle had gone once round.
};

/// All marks of both. *Pure.*
[[nodiscard]] constexpr scan_marks operator|(scan_marks a, scan_marks b) noexcept {
  return static_cast<scan_marks>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
/// The marks that both have. *Pure.*
[[nodiscard]] constexpr scan_marks operator&(scan_marks a, scan_marks b) noexcept {
  return static_cast<scan_marks>(static_cast<unsigned>(a) & static_cast<unsigned>(b));
}

/// One revolution, or a piece of one. A view: `points` lies in the assembler's storage.
struct scan {
  std::span<const point> points;  ///< In the order in which they were measured.
  std::uint32_t revolution = 0;   ///< Of all its points; two pieces of one revolution share it.
  scan_marks marks = scan_marks::none;
  /// The rotation frequency that the device reported with this revolution, 0.1 Hz; 0 if it did not.
  std::uint8_t reported_frequency_dhz = 0;
  std::uint32_t suspect_packets = 0;  ///< Left out of `points`; `data_lost` tells of them too.
  std::uint32_t suspect_samples = 0;  ///< Their samples.
  /// How far the first-level angle went, clockwise degrees, from the first point to the first one of
  /// the next scan, or to its own last one where the stream ended: about 360 for a whole revolution.
  float turned_deg = 0.0F;
  /// The time for that, where both points are there and their times are known; else 0.
  std::int64_t duration_ns = 0;

  /// Whether this is one revolution from zero packet to zero packet with nothing known to be lost.
  [[nodiscard]] constexpr bool is_whole() const noexcept { return marks == scan_marks::none; }
  /// Whether it is anything less.
  [[nodiscard]] constexpr bool is_partial() const noexcept { return !is_whole(); }
  /// Whether it has `mark`, or of several at least one.
  [[nodiscard]] constexpr bool has(scan_marks mark) const noexcept {
    return (marks & mark) != scan_marks::none;
  }
  /// The rotation frequency as measured, in Hz: turns over time where the times are known, else
  /// turns over samples at `samples_per_second`. 0 where it cannot be told.
  [[nodiscard]] constexpr float measured_frequency_hz(
      std::uint32_t samples_per_second) const noexcept {
    const float turns = turned_deg / 360.0F;
    if (duration_ns > 0) return turns * 1e9F / static_cast<float>(duration_ns);
    if (points.empty() || has(scan_marks::data_lost | scan_marks::end_missing)) return 0.0F;
    return turns * static_cast<float>(samples_per_second) / static_cast<float>(points.size());
  }
};

/// Cuts the stream of points into revolutions. *Single thread, never allocates.* A pure state
/// machine over packets; its one state beside the counts is the scan being filled.
///
///     scan being filled   packet                              gives                  then
///     ------------------  ----------------------------------  ---------------------  ------------
///     empty               zero                                nothing                fill, started
///     empty               other                               nothing                fill
///     not empty           zero                                the scan, ended        empty
///     not empty           other, goes beyond 361 degrees      the scan, end missing  empty
///     not empty           other, goes beyond the storage      the scan, end missing  empty
///     not empty           other                               nothing                fill
///     not empty           finish()                            the scan, end missing  empty
///
/// A suspect packet brings no points, and marks the scan that it falls into. A packet that gives a
/// scan is not used up: it is shown again and then meets an empty scan. So a lost zero packet ends in
/// two pieces, the first without an end and the second without a start, and a full storage loses
/// nothing. Every point that goes in comes out in exactly one scan.
class scan_assembler {
 public:
  /// Fills scans into `storage`, which belongs to the caller, outlives this, and sets the largest
  /// scan: 9 kHz at 5 Hz makes 1,800 points. Not empty.
  explicit constexpr scan_assembler(std::span<point> storage) noexcept : storage_(storage) {
    assert(!storage.empty());
  }

  /// Takes the points of `packet` until a scan is complete. The scan is good until the next call of
  /// anything here. Call again with the same `packet`, from whose front the points taken are gone,
  /// until this gives nothing.
  [[nodiscard]] constexpr std::optional<scan> next(decoded& packet) noexcept {
    if (ready_) begin_next();
    noise_ = 0;
    if (packet.starts_revolution) {
      if (!empty()) return complete(packet);
      marks_ = scan_marks::none;  // what was lost before it is lost to no scan
      scan_.reported_frequency_dhz = packet.reported_frequency_dhz;
      packet.starts_revolution = false;
    }
    if (empty()) scan_.revolution = packet.revolution;
    if (packet.suspect) {
      ++scan_.suspect_packets;
      scan_.suspect_samples += packet.sample_count;
      marks_ = marks_ | scan_marks::data_lost;
      packet.suspect = false;
      return std::nullopt;
    }
    return fill(packet);
  }

  /// Tells of bytes that the parser skipped, and marks the scan in which they fall where a packet may
  /// have been among them: for any reason but noise, and noise longer than a packet's header, for a
  /// packet whose first byte is damaged is noise. The stray bytes of healthy devices are no loss.
  constexpr void add(skipped gone) noexcept {
    const bool is_noise = gone.reason == skip_reason::noise;
    if (is_noise) noise_ += gone.count;
    if (!is_noise || noise_ > packet_header_size) lost();
  }

  /// Tells that packets were lost here in another way, so that the scan they belong to is marked.
  constexpr void lost() noexcept {
    if (ready_) begin_next();
    marks_ = marks_ | scan_marks::data_lost;
  }

  /// Gives the last piece, if there is one, when the stream has ended. After that as new, but for
  /// the caller's storage.
  [[nodiscard]] constexpr std::optional<scan> finish() noexcept {
    noise_ = 0;
    if (ready_ || empty()) begin_next();
    if (empty()) return std::nullopt;
    return give(scan_marks::end_missing);
  }

 private:
  static constexpr std::int32_t turn = turn_64ths;
  /// Real zero packets come within half a degree of once round; beyond one degree it is lost.
  static constexpr std::int32_t longest = turn + 64;
  /// A turn that ends this much early was none: the motor stood still or went back and forth.
  static constexpr std::int32_t shortest = turn - 10 * 64;

  [[nodiscard]] constexpr bool empty() const noexcept {
    return used_ == 0 && scan_.suspect_packets == 0;
  }

  /// How far the angle goes from sample `from` of `packet` to sample `to`, 1/64 degree.
  [[nodiscard]] static constexpr std::int32_t way(const decoded& packet, std::size_t from,
                                                  std::size_t to) noexcept {
    const auto before = [&](std::size_t i) {
      return packet.span_64ths * static_cast<std::int32_t>(i) /
             std::max(packet.sample_count - 1, 1);
    };
    return before(to) - before(from);
  }

  /// Moves on within a packet.
  constexpr void advance(std::int32_t way_64ths) noexcept {
    turned_ += way_64ths;
    at_ = (at_ + way_64ths) % turn;
  }
  /// Moves on from packet to packet. Back by up to an eighth of a turn is the motor's doing; further
  /// back is ahead over lost packets.
  constexpr void move_to(std::int32_t angle_64ths) noexcept {
    const std::int32_t ahead = (angle_64ths - at_ + turn) % turn;
    turned_ = std::max(turned_ + (ahead > turn - turn / 8 ? ahead - turn : ahead), -turn);
    at_ = angle_64ths;
  }

  [[nodiscard]] constexpr std::optional<scan> fill(decoded& packet) noexcept {
    if (packet.points.empty()) return std::nullopt;
    const std::size_t first = packet.sample_count - packet.points.size();  // not taken yet
    const std::int32_t angle = (packet.first_angle_64ths + way(packet, 0, first)) % turn;
    if (used_ == 0) at_ = angle;
    move_to(angle);
    std::size_t count = std::min(packet.points.size(), storage_.size() - used_);
    while (count > 0 && turned_ + way(packet, first, first + count - 1) > longest) --count;
    std::copy_n(packet.points.begin(), count,
                storage_.begin() + static_cast<std::ptrdiff_t>(used_));
    used_ += count;
    packet.points = packet.points.subspan(count);
    const bool all = packet.points.empty();
    advance(way(packet, first, all ? first + count - 1 : first + count));
    if (all) return std::nullopt;
    set_duration(packet.points.front());
    return give(scan_marks::end_missing);
  }

  /// Ends the scan before the zero packet `next_packet`.
  [[nodiscard]] constexpr scan complete(const decoded& next_packet) noexcept {
    if (used_ == 0) return give(scan_marks::none);
    move_to(next_packet.first_angle_64ths);
    if (!next_packet.points.empty()) set_duration(next_packet.points.front());
    const bool started = (marks_ & scan_marks::start_missing) == scan_marks::none;
    return give(started && turned_ < shortest ? scan_marks::turn_short : scan_marks::none);
  }

  constexpr void set_duration(const point& next_point) noexcept {
    const std::int64_t from = storage_.front().time_ns;
    if (from != 0 && next_point.time_ns > from) scan_.duration_ns = next_point.time_ns - from;
  }

  [[nodiscard]] constexpr scan give(scan_marks more) noexcept {
    ready_ = true;
    scan_.points = storage_.first(used_);
    scan_.marks = marks_ | more;
    scan_.turned_deg = static_cast<float>(turned_) / 64.0F;
    return scan_;
  }

  constexpr void begin_next() noexcept {
    ready_ = false;
    used_ = 0;
    turned_ = 0;
    scan_ = {};
    marks_ = scan_marks::start_missing;
  }

  std::span<point> storage_;
  std::size_t used_ = 0;
  bool ready_ = false;  // a scan has been given; the next call begins a new one
  scan scan_;
  scan_marks marks_ = scan_marks::start_missing;
  std::int32_t at_ = 0;      // the first-level angle last seen, 1/64 degree
  std::int32_t turned_ = 0;  // since the scan's first sample, 1/64 degree
  std::size_t noise_ = 0;    // bytes of it since the last packet
};

}  // namespace g4lidar
