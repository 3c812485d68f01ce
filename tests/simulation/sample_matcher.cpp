// SPDX-License-Identifier: MIT
#include "sample_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "text.hpp"

namespace g4lidar::simulation {
namespace {

double apart_deg(double a, double b) { return std::abs(std::remainder(a - b, 360.0)); }

/// First and last angle of a packet are rounded to 1/64 degree.
constexpr double angle_slack_deg = 1.0 / 64 + 0.001;
/// A packet's points must differ from those of others within so many.
constexpr std::size_t most_open = 400;

}  // namespace

/// The manual's formula, in double precision and written anew; without a return its limit.
double sample_matcher::corrected_deg(const sim::sample_truth& truth) const {
  const double range_mm =
      truth.raw == 0 ? 1e15 : static_cast<double>(truth.raw) / format_.code.units_per_mm;
  const double turn_rad = std::atan(format_.beam.offset_mm / range_mm - format_.beam.slope);
  return truth.first_level_deg + turn_rad * 180.0 / std::numbers::pi;
}

void sample_matcher::add(std::span<const sim::sent_sample> samples) {
  for (const sim::sent_sample& s : samples) {
    if (s.position == 0 || sent_.empty() || sent_.back().number != s.packet) {
      sent_.push_back({{}, s.packet, s.count, 0, s.truth.first_level_deg, s.zero, s.whole});
      ++counts_.packets;
      counts_.damaged += !s.whole;
    }
    packet& into = sent_.back();
    // A head that went back through 0 looks as if it had gone round.
    const bool is_smeared = into.first_deg < 90.0 && s.truth.first_level_deg > 270.0;
    if (is_smeared && into.whole) {
      into.whole = false;
      ++counts_.damaged;
    }
    into.samples[s.position] = {static_cast<std::int64_t>(s.truth.index),
                                s.truth.time_ns,
                                corrected_deg(s.truth),
                                s.truth.raw,
                                s.truth.intensity,
                                s.truth.flags};
    ++into.known;
  }
}

bool sample_matcher::fits(const packet& sent, std::size_t at) const {
  if (sent.known != sent.count || sent.count > open_.size() - at) return false;
  for (std::size_t i = 0; i < sent.count; ++i) {
    const point& seen = open_[at + i];
    const sample& truth = sent.samples[i];
    const auto units = static_cast<float>(format_.code.units_per_mm);
    if (static_cast<float>(truth.raw) / units != seen.range_mm) return false;
    if (truth.intensity != seen.intensity || truth.flags != seen.sample_flags) return false;
    if (seen.is_revolution_start() != (sent.zero && i == 0)) return false;
    if (apart_deg(truth.angle_deg, static_cast<double>(seen.angle_deg)) > angle_slack_deg)
      return false;
  }
  return true;
}

/// How surely a packet is the one that was delivered: those of one sample and those that saw nothing
/// look the same a turn later. Then what was delivered behind it decides.
sample_matcher::likeness sample_matcher::compare(std::size_t which, std::size_t at) const {
  if (!fits(sent_[which], at)) return likeness::none;
  for (; which < sent_.size() && fits(sent_[which], at); at += sent_[which++].count) {
    const auto begin = sent_[which].samples.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(sent_[which].count);
    const auto returns = std::count_if(begin, end, [](const sample& s) { return s.raw != 0; });
    if (returns >= 5) return likeness::sure;
  }
  const bool ran_out = which == sent_.size() || open_.size() - at < sent_[which].count;
  return ran_out ? likeness::open : likeness::some;
}

/// The packet that begins with this open point: of several that look the same, the first, so that none
/// that may follow is passed over. Looks at packets from the one at `from` on.
sample_matcher::finding sample_matcher::find(std::size_t at, bool all, std::size_t from) const {
  finding best{};
  for (std::size_t i = from; i < sent_.size(); ++i) {
    const likeness like = compare(i, at);
    if (like == likeness::none) continue;
    if (like == likeness::sure) return {i, true, false};
    best.waits = best.waits || (like == likeness::open && !all && open_.size() - at < most_open);
    if (!best.packet) best.packet = i;
  }
  return best;
}

/// The first `blind` open points are of damaged packets, those behind them are of packet `found`.
void sample_matcher::accept(std::size_t found, bool is_sure, std::size_t blind) {
  for (std::size_t i = 0; i < found; ++i) counts_.passed_over += sent_[i].whole;
  for (; blind > 0; --blind) {
    known_.push_back({open_.front(), -1, 0});
    open_.pop_front();
    ++counts_.blind_points;
  }
  const packet& sent = sent_[found];
  for (std::size_t i = 0; i < sent.count; ++i) {
    known_.push_back(
        {open_.front(), is_sure ? sent.samples[i].index : -1, sent.samples[i].time_ns});
    open_.pop_front();
    ++counts_.points;
  }
  sent_.erase(sent_.begin(), sent_.begin() + static_cast<std::ptrdiff_t>(found + 1));
}

/// Takes the first `blind` open points for those of so many damaged packets that the checksum has let
/// pass: if these are just there, and what follows is known. The damaged ones themselves do not follow,
/// though one that saw nothing looks like those that do.
bool sample_matcher::settle_blind(std::size_t blind, std::size_t packets) {
  if (blind >= open_.size()) return false;
  std::size_t behind = 0;
  for (std::size_t damaged = 0; damaged < packets; ++behind) {
    if (behind == sent_.size()) return false;
    if (!sent_[behind].whole) ++damaged;
  }
  const finding found = find(blind, true, behind);
  if (!found.packet) return false;
  counts_.blind_packets += packets;
  accept(*found.packet, found.is_sure, blind);
  return true;
}

/// The first open point is of no packet as it was sent.
bool sample_matcher::settle_unknown(bool all) {
  for (const packet& sent : sent_) {  // most keep their length
    if (!sent.whole && settle_blind(sent.count, 1)) return true;
  }
  std::size_t counts = 0;
  std::size_t packets = 0;
  for (const packet& sent : sent_) {  // several of them, one behind the other
    if (!sent.whole && settle_blind(counts += sent.count, ++packets)) return true;
  }
  for (std::size_t blind = 1; blind < open_.size(); ++blind) {
    if (settle_blind(blind, (blind + max_samples - 1) / max_samples)) return true;
  }
  const bool may_be =
      std::any_of(sent_.begin(), sent_.end(), [](const packet& p) { return !p.whole; });
  if (may_be && !all && open_.size() < most_open) return false;  // more must come
  if (may_be && all && open_.size() <= max_samples) {
    ++counts_.blind_packets;
    counts_.blind_points += open_.size();
    for (const point& p : open_) known_.push_back({p, -1, 0});
    open_.clear();
    return false;
  }
  problem_ =
      text_of("a point that was never sent: %.4f degrees, %.2f mm, %lld ns%s",
              static_cast<double>(open_[0].angle_deg), static_cast<double>(open_[0].range_mm),
              static_cast<long long>(open_[0].time_ns),
              open_[0].is_revolution_start() ? ", a zero packet's" : "");
  open_.clear();
  return false;
}

void sample_matcher::drop_rest_of_packet() {
  is_cut_ = false;
  for (std::size_t rest = 0; rest < std::min(open_.size(), max_samples); ++rest) {
    if (!find(rest, true).packet) continue;
    open_.erase(open_.begin(), open_.begin() + static_cast<std::ptrdiff_t>(rest));
    return;
  }
}

bool sample_matcher::settle_one(bool all) {
  if (is_cut_) drop_rest_of_packet();
  const finding found = find(0, all);
  if (found.waits) return false;
  if (!found.packet) return settle_unknown(all);
  accept(*found.packet, found.is_sure, 0);
  return true;
}

std::span<const known_point> sample_matcher::settle(bool all) {
  known_.clear();
  while (!open_.empty() && settle_one(all)) {
  }
  return known_;
}

}  // namespace g4lidar::simulation
