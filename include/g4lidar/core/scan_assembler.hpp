// SPDX-License-Identifier: MIT
// Assembles revolutions: points cut at the zero packets, in the caller's storage.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"

namespace g4lidar {

/// Cuts the stream of points into revolutions. *Single thread, never allocates.* A pure state
/// machine over packets; its only state, except counts, is the scan being filled.
///
///     scan being filled   packet                              gives                  then
///     ------------------  ----------------------------------  ---------------------  --------------
///     empty               zero                                nothing                fill, started
///     empty               other                               nothing                fill
///     not empty           zero                                the scan, ended        empty
///     not empty           other, goes beyond 361 degrees      the scan up to 360     what is beyond
///     not empty           other, goes beyond the storage      the scan, end missing  empty
///     not empty           other                               nothing                fill
///     not empty           finish()                            the scan, end missing  empty
///
/// Angles are counted from the angle of the last zero packet, so a revolution whose zero packet was
/// lost is cut where the angle passes that angle: `end_by_angle`, and the next one
/// `start_by_angle`. The loss of the zero packet is detected one degree later; the points of that
/// degree move to the next scan. A suspect packet contributes no points, and flags the scan in
/// which it was received. A packet that completes a scan is not consumed: pass it again. Every
/// point is in exactly one scan.
class scan_assembler {
 public:
  /// Fills scans into `storage`, which the caller owns and which outlives this object. Its size
  /// limits a scan: 9 kHz at 5 Hz makes 1,800 points. Not empty.
  /// The scans are of a lidar of the model `model`, which is valid as long as they are.
  explicit constexpr scan_assembler(std::span<point> storage,
                                    const model& model = g4_model) noexcept
      : storage_(storage), sample_rate_hz_(first_rate_hz(model)) {
    assert(!storage.empty());
    scan_.model = &model;
  }

  /// The next scans are of a lidar like `model`, which is valid as long as they are.
  constexpr void become(const model& model) noexcept { scan_.model = &model; }

  /// The nominal sample rate of the next packets, for the scans.
  constexpr void set_sample_rate(std::uint32_t hz) noexcept { sample_rate_hz_ = hz; }

  /// The free part of the storage. next() does not copy the points of the next packet if they were
  /// decoded to its front. Invalidates the last scan.
  [[nodiscard]] constexpr std::span<point> room() noexcept {
    if (ready_) begin_next();
    return storage_.subspan(used_);
  }

  /// The points of the scan being filled. Valid until the next call of any other function.
  [[nodiscard]] constexpr std::span<const point> unfinished() const noexcept {
    return storage_.subspan(given_, used_ - given_);
  }

  /// Takes the points of `packet` until a scan is complete. The scan is valid until the next call
  /// of any function. Call it again with the same `packet`, from whose front the taken points are
  /// removed, until it returns nothing. It has at most `sample_count` points; more are left out.
  [[nodiscard]] constexpr std::optional<scan> next(decoded& packet) noexcept {
    if (ready_) begin_next();
    noise_ = 0;
    if (packet.starts_revolution) {
      if (!empty()) return complete(packet);
      restart();
      flags_ = scan_flags::none;  // a loss before the first point belongs to no scan
      at_ = packet.first_angle_64ths;
      scan_.reported_frequency_chz = static_cast<std::uint16_t>(
          true_frequency_chz(*scan_.model, int{packet.reported_frequency_chz}));
      packet.starts_revolution = false;
    }
    if (empty()) scan_.revolution = packet.revolution;
    if (packet.suspect) {
      ++scan_.suspect_packets;
      scan_.suspect_samples += packet.sample_count;
      has_loss_ = true;
      packet.suspect = false;
      return std::nullopt;
    }
    return fill(packet);
  }

  /// Reports bytes that the parser skipped, and flags the scan to which they belong if they may
  /// have contained a packet: with any reason except noise, and with noise longer than a packet
  /// header, because a packet whose first byte is damaged is skipped as noise. The stray bytes of
  /// healthy devices are no loss.
  constexpr void add(skipped gone) noexcept {
    const bool is_noise = gone.reason == skip_reason::noise;
    if (is_noise) noise_ += gone.count;
    if (!is_noise || noise_ > packet_header_size) lost();
  }

  /// Reports that packets were lost at this place, so that the scan to which they belong is
  /// flagged. If the cut by the angle is within the loss, both scans are flagged.
  constexpr void lost() noexcept {
    if (ready_) begin_next();
    has_loss_ = true;
  }

  /// Reports that the CRC byte before the zero packet that is passed next does not fit, so that the
  /// scan which ends there is flagged. See ct_check.
  constexpr void crc_mismatch() noexcept {
    if (ready_) begin_next();
    flags_ = flags_ | scan_flags::crc_mismatch;
  }

  /// Returns the last piece, if there is one, when the stream has ended. After that this object is
  /// as after construction.
  [[nodiscard]] constexpr std::optional<scan> finish() noexcept {
    if (ready_) begin_next();
    std::optional<scan> last;
    if (!empty()) {
      take_loss();
      last = give(scan_flags::end_missing, used_, turned_, nullptr);
    }
    noise_ = 0;
    turn_ns_ = 0;
    at_ = unknown;
    restart();
    next_flags_ = scan_flags::start_missing;
    if (!last) begin_next();
    return last;
  }

 private:
  static constexpr std::int32_t turn = turn_64ths;
  /// Real zero packets come within half a degree of a full turn; after one degree it is lost.
  static constexpr std::int32_t longest = turn + 64;
  /// A turn that ends so early is none: the motor did not turn, or moved back and forth.
  static constexpr std::int32_t shortest = turn - 10 * 64;
  static constexpr std::int32_t unknown = -1;

  [[nodiscard]] constexpr bool empty() const noexcept {
    return used_ == 0 && scan_.suspect_packets == 0;
  }
  [[nodiscard]] constexpr bool is_beyond() const noexcept { return beyond_ < used_; }

  /// The turn from sample `from` of `packet` to sample `to`, 1/64 degree.
  [[nodiscard]] static constexpr std::int32_t way(const decoded& packet, std::size_t from,
                                                  std::size_t to) noexcept {
    const auto before = [&](std::size_t i) {
      return packet.span_64ths * static_cast<std::int32_t>(i) /
             std::max(packet.sample_count - 1, 1);
    };
    return before(to) - before(from);
  }

  /// An angle below two turns within the turn.
  [[nodiscard]] static constexpr std::int32_t within_turn(std::int32_t angle_64ths) noexcept {
    return angle_64ths >= turn ? angle_64ths - turn : angle_64ths;
  }

  /// Advances within a packet.
  constexpr void advance(std::int32_t way_64ths) noexcept {
    turned_ += way_64ths;
    at_ = within_turn(at_ + way_64ths);
  }
  /// Advances from packet to packet. A step back by up to an eighth of a turn is a movement of the
  /// motor; a longer one is a step ahead over lost packets, plus whole turns if the times show
  /// them.
  constexpr void move_to(std::int32_t angle_64ths, std::span<const point> there) noexcept {
    if (at_ == unknown) at_ = angle_64ths;
    const std::int32_t ahead = (angle_64ths - at_ + turn) % turn;
    const std::int32_t gap = there.empty() ? 0 : way_by_time(there.front());
    std::int32_t moved = ahead > turn - turn / 8 ? ahead - turn : ahead;
    if (gap > 0) moved = ahead + std::max<std::int32_t>((gap - ahead + turn / 2) / turn, 0) * turn;
    turned_ = std::max(turned_ + moved, -turn);
    at_ = angle_64ths;
    if (turned_ >= turn || !is_beyond()) return;
    beyond_ = none_beyond;
    flags_ = flags_ | next_flags_;
    next_flags_ = scan_flags::none;
  }
  /// The turn from the last point to `next`, by the duration of the last turn; 0 if it is not
  /// known, or less than half a turn.
  [[nodiscard]] constexpr std::int32_t way_by_time(const point& next) const noexcept {
    if (turn_ns_ == 0 || used_ == 0 || storage_[used_ - 1].time_ns == 0) return 0;
    const std::int64_t taken = detail::saturating_sub(next.time_ns, storage_[used_ - 1].time_ns);
    if (taken <= turn_ns_ / 2) return 0;
    return static_cast<std::int32_t>(std::min(taken, 99 * turn_ns_) * turn / turn_ns_);
  }

  [[nodiscard]] constexpr std::optional<scan> fill(decoded& packet) noexcept {
    if (packet.points.size() > packet.sample_count) {  // a mistake of the caller
      packet.points = packet.points.first(packet.sample_count);
    }
    if (packet.points.empty()) return std::nullopt;
    const std::size_t first = packet.sample_count - packet.points.size();  // not taken yet
    move_to(within_turn(packet.first_angle_64ths + way(packet, 0, first)), packet.points);
    take_loss();
    if (used_ == 0) first_turned_ = turned_;
    std::size_t count = std::min(packet.points.size(), storage_.size() - used_);
    std::int32_t last = way(packet, first, first + count - 1);  // of the samples that are taken
    if (turned_ + last >= turn) {
      while (count > 0 && turned_ + last > longest) last = way(packet, first, first + --count - 1);
      find_turn(packet, first, count);
    }
    const auto place = storage_.begin() + static_cast<std::ptrdiff_t>(used_);
    // g++ 11: a constant expression cannot compare pointers into two arrays.
    if (std::is_constant_evaluated() || packet.points.data() != storage_.data() + used_) {
      std::copy_n(packet.points.begin(), count, place);
    }
    used_ += count;
    packet.points = packet.points.subspan(count);
    const bool all = packet.points.empty();
    advance(all ? last : way(packet, first, first + count));
    if (all) return std::nullopt;
    return cut(packet.points);
  }

  /// Stores which of the next `count` samples is the first one beyond the turn, if one is.
  constexpr void find_turn(const decoded& packet, std::size_t first, std::size_t count) noexcept {
    if (is_beyond() || count == 0) return;
    const auto turned_at = [&](std::size_t i) { return turned_ + way(packet, first, first + i); };
    if (turned_at(count - 1) < turn) return;
    std::size_t i = 0;
    while (turned_at(i) < turn) ++i;
    beyond_ = used_ + i;
    beyond_turned_ = turned_at(i);
  }

  /// Ends the scan, without a zero packet, before the points `next`.
  [[nodiscard]] constexpr scan cut(std::span<const point> next) noexcept {
    if (turned_ < turn) {
      const scan full = give(scan_flags::end_missing, used_, turned_, next.data());
      next_flags_ = scan_flags::start_missing;
      return full;
    }
    const bool has_rest = is_beyond();
    const std::int32_t end = has_rest ? beyond_turned_ : turned_;
    const point* const behind = has_rest ? storage_.data() + beyond_ : next.data();
    const scan result = give(scan_flags::end_by_angle, std::min(beyond_, used_), end, behind);
    next_flags_ = next_flags_ | scan_flags::start_by_angle;
    turned_ = has_rest ? turned_ - turn : turned_ % turn;
    first_turned_ = end % turn;
    beyond_ = none_beyond;
    return result;
  }

  /// Ends the scan before the zero packet `zero`.
  [[nodiscard]] constexpr scan complete(const decoded& zero) noexcept {
    take_loss();
    if (used_ == 0) return give(scan_flags::none, 0, turned_, nullptr);
    move_to(zero.first_angle_64ths, zero.points);
    if (turned_ >= turn + shortest) return cut(zero.points);
    flags_ = flags_ | next_flags_;
    const bool started = (flags_ & scan_flags::start_missing) == scan_flags::none;
    return give(started && turned_ < shortest ? scan_flags::turn_short : scan_flags::none, used_,
                turned_, zero.points.data());
  }

  /// Flags the scans that contain a loss which ends here.
  constexpr void take_loss() noexcept {
    if (!has_loss_) return;
    has_loss_ = false;
    if (!is_beyond()) flags_ = flags_ | scan_flags::data_lost;
    if (turned_ >= turn) next_flags_ = next_flags_ | scan_flags::data_lost;
  }

  /// The first `count` points, which end at `end_64ths`, with the following point `behind`, if any.
  [[nodiscard]] constexpr scan give(scan_flags more, std::size_t count, std::int32_t end_64ths,
                                    const point* behind) noexcept {
    ready_ = true;
    given_ = count;
    scan_.points = storage_.first(count);
    scan_.flags = flags_ | more;
    scan_.sample_rate_hz = sample_rate_hz_;
    scan_.turned_deg = static_cast<float>(end_64ths - first_turned_) / 64.0F;
    const std::int64_t from = scan_.time_ns();
    if (from != 0 && behind != nullptr && behind->time_ns > from) {
      scan_.duration_ns = detail::saturating_sub(behind->time_ns, from);
      const std::int64_t turned = end_64ths - first_turned_;
      const bool is_turning = turned > turn / 2 && scan_.duration_ns < 10'000'000'000;
      if (is_turning) turn_ns_ = scan_.duration_ns * turn / turned;
    }
    return scan_;
  }

  constexpr void begin_next() noexcept {
    ready_ = false;
    const auto at = [&](std::size_t i) {
      return storage_.begin() + static_cast<std::ptrdiff_t>(i);
    };
    std::copy(at(given_), at(used_), at(0));
    used_ -= given_;
    given_ = 0;
    const model& which = *scan_.model;
    scan_ = {};
    scan_.model = &which;
    if (used_ > 0) scan_.revolution = storage_.front().revolution;
    flags_ = next_flags_;
    next_flags_ = scan_flags::none;
  }
  constexpr void restart() noexcept {
    turned_ = 0;
    first_turned_ = 0;
    beyond_ = none_beyond;
    has_loss_ = false;
    next_flags_ = scan_flags::none;
  }

  static constexpr std::size_t none_beyond = SIZE_MAX;

  std::span<point> storage_;
  std::size_t used_ = 0;
  std::size_t given_ = 0;             // points in the scan that was returned
  std::size_t beyond_ = none_beyond;  // the first point beyond a full turn
  bool ready_ = false;                // a scan was returned; the next call begins a new one
  bool has_loss_ = false;             // since the last point
  scan scan_;
  scan_flags flags_ = scan_flags::start_missing;
  scan_flags next_flags_ = scan_flags::none;  // of the points beyond the turn, and of the next scan
  std::uint32_t sample_rate_hz_;
  std::int32_t at_ = unknown;       // the first-level angle last seen, 1/64 degree
  std::int32_t turned_ = 0;         // since the last zero angle, 1/64 degree
  std::int32_t first_turned_ = 0;   // the same at the first point
  std::int32_t beyond_turned_ = 0;  // the same at the first point beyond
  std::int64_t turn_ns_ = 0;        // the time of the last turn
  std::size_t noise_ = 0;           // bytes of noise since the last packet
};

}  // namespace g4lidar
