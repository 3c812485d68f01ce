// SPDX-License-Identifier: MIT
#include "doctor_stream.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>
#include <variant>

namespace g4_dump {
namespace {

using namespace g4lidar;

constexpr std::size_t max_between = 2 * max_packet_size;
/// A stretch this long without a packet is no part of an even pace.
constexpr std::int64_t pause_ns = 60'000'000;
/// What is lost of a backlog is missed as late after it.
constexpr std::int64_t backlog_time_ns = 100'000'000;
/// Rounding, or a jerk, may leave the next angle a little before this one.
constexpr double nearly_round_deg = 358.0;
/// Bytes a packet that single losses take; more is a cut.
constexpr std::size_t few_bytes = 5;

double forward_deg(double from, double to) noexcept {
  const double way = std::fmod(to - from, 360.0);
  return way < 0.0 ? way + 360.0 : way;
}

}  // namespace

void stream_watch::begin(std::int64_t now_ns) {
  stream_watch fresh;
  fresh.judging_ = true;
  fresh.steps_ = steps_;
  fresh.step_count_ = step_count_;
  fresh.zero_deg_ = zero_deg_;
  fresh.last_ = last_;
  fresh.sizes_ = sizes_;
  fresh.last_packet_ns_ = std::max(last_packet_ns_, now_ns);
  fresh.between_size_ = max_between + 1;  // what came before is not judged
  fresh.stalled_here_ = true;
  *this = std::move(fresh);
}

void stream_watch::part() noexcept {
  last_.reset();
  between_.clear();
  between_size_ = 0;
}

void stream_watch::take(const batch& came) {
  bytes_ += came.count;
  batch_bytes_[std::min(came.count, batch_bytes_.size() - 1)] += came.count;
  if (came.silence_ns >= stall_ns) {
    ++stalls_;
    stalled_here_ = true;
    backlog_ns_ = came.arrival_ns + backlog_time_ns;
  }
  longest_silence_ns_ = std::max(longest_silence_ns_, came.silence_ns);
}

void stream_watch::take(const heard& came) {
  counts_.add(came.what);
  if (const auto* packet = std::get_if<packet_view>(&came.what)) {
    return take_packet(*packet, came.arrival_ns);
  }
  between_answers_ = between_answers_ || std::holds_alternative<response_view>(came.what);
  between_size_ += came.raw.size();
  since_packet_ += came.raw.size();
  if (between_.size() + came.raw.size() > max_between) return;
  between_.insert(between_.end(), came.raw.begin(), came.raw.end());
}

void stream_watch::take_packet(packet_view packet, std::int64_t arrival_ns) {
  last_packet_ns_ = arrival_ns;
  since_packet_ = 0;
  samples_ += packet.sample_count();
  ++sizes_[packet.sample_count()];
  const int reported = packet.reported_frequency_dhz();
  if (packet.is_zero()) {
    zero_deg_ = packet.first_angle_64ths() / 64.0;
    if (reported > 0) {
      reported_dhz_ += static_cast<std::uint64_t>(reported);
      ++reports_;
    }
  }
  if (packet.is_suspect() || (judging_ && is_jerk(packet))) {
    ++jerks_;
    return part();
  }
  const place now{arrival_ns, packet.last_angle_64ths() / 64.0, packet.first_angle_64ths() / 64.0,
                  packet.sample_count()};
  if (last_) {
    if (between_size_ <= 1) learn_step(*last_, now);
    if (judging_) judge(*last_, now, packet.is_zero());
  }
  last_ = now;
  between_.clear();
  between_size_ = 0;
  between_answers_ = false;
  stalled_here_ = false;
}

// A way back through zero looks like one nearly all the way round.
bool stream_watch::is_jerk(packet_view packet) const {
  const std::optional<double> step = step_deg();
  if (!step || packet.sample_count() < 8) return false;
  const double expected_deg = *step * static_cast<double>(packet.sample_count() - 1);
  return packet.span_64ths() / 64.0 > 2.0 * expected_deg + 1.0;
}

void stream_watch::learn_step(const place& before, const place& now) {
  const double way = forward_deg(before.first_deg, now.first_deg);
  steps_[step_count_++ % steps_.size()] = way / static_cast<double>(before.samples);
}

std::optional<double> stream_watch::step_deg() const {
  const std::size_t count = std::min(step_count_, steps_.size());
  if (count < 9) return std::nullopt;
  std::array<double, 31> sorted = steps_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

void stream_watch::judge(const place& before, const place& now, bool is_zero) {
  const std::optional<double> step = step_deg();
  if (!step || *step <= 0.0) return;
  const double way = forward_deg(before.last_deg, now.first_deg);
  const double missing = way > nearly_round_deg ? 0.0 : std::max(0.0, way / *step - 1.0);
  const auto whole = static_cast<std::uint64_t>(std::llround(missing));
  lost_ += whole;
  measure_pace(before, now, missing);
  if (stalled_here_ || between_answers_ || now.arrival_ns < backlog_ns_) return;
  const double size = static_cast<double>(packet_samples());
  const double packets = std::round(missing / size);
  const bool has_index =
      is_zero || now.first_deg < before.last_deg ||
      (zero_deg_ && forward_deg(before.last_deg, *zero_deg_) <= way && missing >= 0.5);
  if (has_index) {
    const bool is_healthy = whole == 0 && between_size_ <= 1;
    if (!is_healthy) ++damage_.unclear;
    return;
  }
  if (std::abs(missing - packets * size) > 1.5 + 0.02 * missing) {
    ++damage_.unclear;
    return;
  }
  judge_bytes(static_cast<std::size_t>(packets));
}

void stream_watch::judge_bytes(std::size_t lost_packets) {
  const std::size_t expected = lost_packets * packet_size(packet_samples());
  if (between_size_ == expected) {
    if (lost_packets == 0) return;
    ++damage_.changed;
    damage_.changed_packets += lost_packets;
    if (lost_packets == 1 && between_.size() == expected) {
      const g4lidar::bytes frame = between_;
      const auto wrong = static_cast<std::uint16_t>(packet_checksum(frame) ^ load_u16(frame, 8));
      ++damage_.one_packet;
      damage_.wrong_bits += static_cast<std::uint64_t>(std::popcount(wrong));
    }
  } else if (between_size_ == 0) {
    damage_.vanished += lost_packets;
  } else if (between_size_ > expected) {
    ++damage_.lengthened;
  } else if (expected - between_size_ <= few_bytes * lost_packets) {
    ++damage_.shortened;
  } else {
    ++damage_.cut;
  }
}

void stream_watch::measure_pace(const place& before, const place& now, double missing) {
  const std::int64_t took_ns = now.arrival_ns - before.arrival_ns;
  if (took_ns > pause_ns || stalled_here_) return;
  pace_ns_ += took_ns;
  pace_samples_ += static_cast<double>(now.samples) + missing;
  const double way = forward_deg(before.last_deg, now.first_deg);
  const double there_deg = way > nearly_round_deg ? way - 360.0 : way;
  pace_deg_ += there_deg + forward_deg(now.first_deg, now.last_deg);
}

double stream_watch::sample_rate_hz() const noexcept {
  if (pace_ns_ < 100'000'000) return 0.0;
  return pace_samples_ / (static_cast<double>(pace_ns_) / 1e9);
}

double stream_watch::frequency_hz() const noexcept {
  if (pace_ns_ < 100'000'000) return 0.0;
  return pace_deg_ / 360.0 / (static_cast<double>(pace_ns_) / 1e9);
}

double stream_watch::reported_hz() const noexcept {
  if (reports_ == 0) return 0.0;
  return static_cast<double>(reported_dhz_) / static_cast<double>(reports_) / 10.0;
}

std::size_t stream_watch::packet_samples() const noexcept {
  std::size_t most = 1;
  for (std::size_t size = 2; size < sizes_.size(); ++size) {
    if (sizes_[size] > sizes_[most] || (sizes_[size] > 0 && most == 1)) most = size;
  }
  return most;
}

double stream_watch::held_back_ms(std::uint32_t baud) const noexcept {
  if (baud == 0 || bytes_ == 0) return 0.0;
  std::uint64_t seen = 0;
  std::size_t size = 0;
  while (size + 1 < batch_bytes_.size() && 2 * (seen += batch_bytes_[size]) < bytes_) ++size;
  return static_cast<double>(size) * 10'000.0 / static_cast<double>(baud);
}

// Single bits that fall as they may hit a share f of the packets: then 1 / (1 - f) packets are hit in
// a row on the average, and -log(1 - f) / f bits of those that are hit. Noise that lasts exceeds both.
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

std::vector<diagnosis> diagnoses_of(const stream_watch& watched) {
  const damage_counts& damage = watched.damage();
  const bool is_burst = comes_in_bursts(damage, watched.counts().packets);
  std::vector<std::pair<std::uint64_t, diagnosis>> kinds{
      {damage.changed, is_burst ? diagnosis::bursts : diagnosis::bits_flipped},
      {damage.shortened, diagnosis::bytes_dropped},
      {damage.cut, diagnosis::packets_truncated},
      {damage.lengthened, diagnosis::bytes_inserted},
      {damage.vanished, diagnosis::packets_lost}};
  std::sort(kinds.begin(), kinds.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  });
  const std::uint64_t told = damage.all() - damage.unclear;
  std::vector<diagnosis> found;
  for (const auto& [count, what] : kinds) {
    if (count == 0 || (!found.empty() && 4 * count < told)) continue;
    found.push_back(what);
  }
  if (found.empty() && damage.unclear > 0) found.push_back(diagnosis::line_noise);
  return found;
}

}  // namespace g4_dump
