// SPDX-License-Identifier: MIT
#include "stream_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <variant>

#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {
namespace {

constexpr std::size_t max_between = 2 * max_packet_size;
/// A stretch this long without a packet may contain a whole revolution.
constexpr std::int64_t pause_ns = 60'000'000;
/// A loss in a backlog is detected at most this much later.
constexpr std::int64_t backlog_time_ns = 100'000'000;
/// By rounding, or by a jolt, the next angle may be this much before the previous one.
constexpr double nearly_round_deg = 358.0;
/// The maximum number of bytes per packet lost singly; more is a truncation.
constexpr std::size_t few_bytes = 5;
/// A head that turns less than this per sample is stopped.
constexpr double standing_deg = 0.02;
/// The largest change of its speed between two checks.
constexpr double steady_ratio = 0.01;

/// From one angle to another, both from 0 to below 360.
double forward_deg(double from, double to) noexcept {
  const double way = to - from;
  return way < 0.0 ? way + 360.0 : way;
}

/// The same for two adjacent positions: it may be slightly negative.
double way_deg(double from, double to) noexcept {
  const double way = forward_deg(from, to);
  return way > nearly_round_deg ? way - 360.0 : way;
}

/// Whether changes are bursts, and not independent single bits.
// If single bits are independent and damage a share f of the packets, the mean run of damaged
// packets is 1 / (1 - f), with -log(1 - f) / f bits in each. Bursts exceed both values.
bool comes_in_bursts(const damage_counts& damage, std::uint64_t good_packets) {
  if (damage.changed == 0) return false;
  const auto hit = static_cast<double>(damage.changed_packets);
  const double share = hit / (hit + static_cast<double>(good_packets));
  const double in_a_row = hit / static_cast<double>(damage.changed);
  if (in_a_row > 1.5 / (1.0 - share) + 0.25) return true;
  if (damage.one_packet == 0) return false;
  const double bits =
      static_cast<double>(damage.wrong_bits) / static_cast<double>(damage.one_packet);
  return bits > 1.5 * -std::log1p(-share) / share + 1.5;
}

}  // namespace

void step_median::add(double step_deg) noexcept {
  steps_[count_++ % steps_.size()] = step_deg;
  if (count_ <= steps_.size() || count_ % 8 == 0) recent_ = get();
}

std::optional<double> step_median::get() const {
  const std::size_t count = std::min(count_, steps_.size());
  if (count < 9) return std::nullopt;
  std::array<double, 31> sorted = steps_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

void stream_statistics::begin() {
  static_cast<void>(next_stretch());
  judging_ = true;
  between_ = {.size = max_between + 1, .is_unsure = true};  // the bytes before are not evaluated
  since_packet_ = 0;
}

stream_tally stream_statistics::next_stretch() {
  tally_.pace.part();
  const ct_check crc = tally_.counts.crc;
  stream_tally ended =
      std::exchange(tally_, {.pace = sample_pace(*which_), .returns = return_map(is_long_)});
  tally_.counts.crc = crc;
  return ended;
}

void stream_statistics::add(const stream_tally& earlier) {
  tally_.pace.part();
  tally_.add(earlier);
  steady_ = 2 * tally_.unsteady <= tally_.checks && !stands();
}

void stream_statistics::part() {
  last_.reset();
  between_ = {};
  tally_.pace.part();
}

void stream_statistics::suspend() {
  part();
  tally_.counts.crc = {};
  judging_ = false;
  steps_ = {};
}

void stream_statistics::resume() {
  part();
  judging_ = true;
}

bool stream_statistics::is_steady() {
  const double step = step_deg().value_or(0.0);
  steady_ = step > standing_deg && std::abs(step - step_before_) < steady_ratio * step;
  step_before_ = step;
  ++tally_.checks;
  if (!steady_) ++tally_.unsteady;
  return steady_;
}

bool stream_statistics::stands() const { return step_deg().value_or(1.0) <= standing_deg; }

void stream_statistics::take(const timed_read& observed) {
  tally_.arrivals.take(observed);
  if (std::max(observed.silence_ns, observed.host_pause_ns) < arrival_statistics::stall_ns) return;
  between_.is_unsure = true;
  backlog_ns_ = detail::saturating_add(observed.arrival_ns, backlog_time_ns);
}

void stream_statistics::take(const observed_event& observed) {
  tally_.counts.add(observed.what);
  if (const auto* packet = std::get_if<packet_view>(&observed.what)) {
    return take_packet(*packet, observed.arrival_ns);
  }
  const bool is_empty = std::holds_alternative<empty_packet_view>(observed.what);
  if (is_empty || std::holds_alternative<time_packet_view>(observed.what)) return;
  between_.has_answers |= std::holds_alternative<response_view>(observed.what);
  between_.size += observed.raw.size();
  since_packet_ += observed.raw.size();
  if (between_.raw.size() + observed.raw.size() > max_between) return;
  between_.raw.insert(between_.raw.end(), observed.raw.begin(), observed.raw.end());
}

void stream_statistics::take_packet(packet_view packet, std::int64_t arrival_ns) {
  since_packet_ = 0;
  const std::size_t samples = packet.sample_count();
  tally_.samples += samples;
  ++sizes_[samples];
  const bool is_usual = usual_size_ == 1 || sizes_[samples] > sizes_[usual_size_];
  if (samples > 1 && is_usual) usual_size_ = samples;
  const int reported = packet.reported_frequency_chz();
  if (packet.is_zero()) {
    zero_deg_ = packet.first_angle_64ths() / 64.0;
    if (reported > 0) {
      tally_.reported.sum += reported;
      tally_.reported.count += 1.0;
    }
  }
  if (packet.is_suspect() || (judging_ && is_jerk(packet))) {
    ++tally_.jerks;
    return part();
  }
  tally_.returns.take(packet, which_->samples);
  const place now{arrival_ns, packet.last_angle_64ths() / 64.0, packet.first_angle_64ths() / 64.0,
                  samples};
  if (last_) {
    if (between_.size <= 1) {
      const double way = forward_deg(last_->first_deg, now.first_deg);
      steps_.add(way / static_cast<double>(last_->samples));
    }
    if (judging_) judge(*last_, now, packet.is_zero());
  }
  last_ = now;
  between_.raw.clear();
  between_ = {.raw = std::move(between_.raw)};
}

// A step back through zero looks like a step of nearly a full turn.
bool stream_statistics::is_jerk(packet_view packet) const {
  const std::optional<double> step = steps_.recent();
  if (!step || packet.sample_count() < 8) return false;
  const double expected_deg = *step * static_cast<double>(packet.sample_count() - 1);
  return packet.span_64ths() / 64.0 > 2.0 * expected_deg + 1.0;
}

void stream_statistics::judge(const place& before, const place& now, bool is_zero) {
  const std::optional<double> step = steps_.recent();
  if (!step || *step <= 0.0) return;
  const double way = forward_deg(before.last_deg, now.first_deg);
  const double missing = way > nearly_round_deg ? 0.0 : std::max(0.0, way / *step - 1.0);
  const auto whole = static_cast<std::uint64_t>(std::llround(missing));
  tally_.lost += whole;
  measure_pace(before, now, static_cast<std::size_t>(whole));
  if (between_.is_unsure || between_.has_answers || now.arrival_ns < backlog_ns_) return;
  const double size = static_cast<double>(usual_size_);
  const double packets = std::round(missing / size);
  const bool has_index =
      is_zero || now.first_deg < before.last_deg ||
      (zero_deg_ && forward_deg(before.last_deg, *zero_deg_) <= way && missing >= 0.5);
  if (has_index) {
    const bool is_healthy = whole == 0 && between_.size <= 1;
    if (!is_healthy) ++tally_.damage.unclear;
    return;
  }
  if (std::abs(missing - packets * size) > 1.5 + 0.02 * missing) {
    ++tally_.damage.unclear;
    return;
  }
  judge_bytes(static_cast<std::size_t>(packets));
}

void stream_statistics::judge_bytes(std::size_t lost_packets) {
  const sample_layout layout = which_->samples.layout;
  const std::size_t expected = lost_packets * packet_size(usual_size_, layout);
  if (between_.size == expected) {
    if (lost_packets == 0) return;
    ++tally_.damage.changed;
    tally_.damage.changed_packets += lost_packets;
    if (lost_packets == 1 && between_.raw.size() == expected) {
      const bytes packet = between_.raw;
      const auto wrong =
          static_cast<std::uint16_t>(packet_checksum(packet, layout) ^ load_u16(packet, 8));
      ++tally_.damage.one_packet;
      tally_.damage.wrong_bits += static_cast<std::uint64_t>(std::popcount(wrong));
    }
  } else if (between_.size == 0) {
    tally_.damage.vanished += lost_packets;
  } else if (between_.size > expected) {
    ++tally_.damage.lengthened;
  } else if (expected - between_.size <= few_bytes * lost_packets) {
    ++tally_.damage.shortened;
  } else {
    ++tally_.damage.cut;
  }
}

// The angles show how many samples are missing, but not how many revolutions.
void stream_statistics::measure_pace(const place& before, const place& now, std::size_t missing) {
  const bool may_miss_revolutions =
      between_.is_unsure || now.arrival_ns < backlog_ns_ ||
      detail::saturating_sub(now.arrival_ns, before.arrival_ns) > pause_ns;
  if (may_miss_revolutions && missing > 0) return tally_.pace.part();
  const std::size_t samples = now.samples + missing;
  // Bytes that have waited are late: a line that begins with them is too steep.
  const bool is_late_start = tally_.pace.is_empty() && now.arrival_ns < backlog_ns_;
  const bool has_time = now.arrival_ns != 0;
  if (has_time && !is_late_start) tally_.pace.add(samples, now.arrival_ns);
  tally_.turned.sum +=
      way_deg(before.last_deg, now.first_deg) + forward_deg(now.first_deg, now.last_deg);
  tally_.turned.count += static_cast<double>(samples);
}

std::vector<diagnosis> diagnoses_of(const stream_statistics& measured) {
  const damage_counts& damage = measured.tally().damage;
  const bool is_burst = comes_in_bursts(damage, measured.tally().counts.packets);
  std::vector<std::pair<std::uint64_t, diagnosis>> kinds{
      {damage.changed, is_burst ? diagnosis::bursts : diagnosis::bits_flipped},
      {damage.shortened, diagnosis::bytes_dropped},
      {damage.cut, diagnosis::packets_truncated},
      {damage.lengthened, diagnosis::bytes_inserted},
      {damage.vanished, diagnosis::packets_lost}};
  std::sort(kinds.begin(), kinds.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  const std::uint64_t explained = damage.all() - damage.unclear;
  std::vector<diagnosis> found;
  for (const auto& [count, what] : kinds) {
    if (count == 0 || (!found.empty() && 4 * count < explained)) continue;
    found.push_back(what);
  }
  // A revolution lost a packet where its damage cannot be evaluated.
  const stream_counter& counts = measured.tally().counts;
  const bool is_whole = damage.unclear > 0 && counts.skipped_bytes() == 0;
  if (found.empty() && (counts.crc_mismatches > 0 || is_whole)) return {diagnosis::packets_lost};
  if (found.empty() && damage.unclear > 0) found.push_back(diagnosis::line_noise);
  return found;
}

}  // namespace g4lidar
