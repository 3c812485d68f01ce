// SPDX-License-Identifier: MIT
#include "truth_book.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "text.hpp"

namespace g4lidar::lives {
namespace {

/// The manual's formula, in double precision and written anew.
double corrected_deg(double first_level_deg, std::uint16_t raw) {
  if (raw == 0) return first_level_deg;
  const double range_mm = raw / 4.0;
  const double turn_rad = std::atan(21.8 * (155.3 - range_mm) / (155.3 * range_mm));
  return first_level_deg + turn_rad * 180.0 / std::numbers::pi;
}

double apart_deg(double a, double b) { return std::abs(std::remainder(a - b, 360.0)); }

/// First and last angle of a packet are rounded to 1/64 degree.
constexpr double angle_slack_deg = 1.0 / 64 + 0.001;
/// A packet's points must be told apart from those of others within so many.
constexpr std::size_t most_open = 400;

}  // namespace

void truth_book::add(std::span<const sim::sent_sample> samples) {
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
    into.samples[s.position] = {static_cast<std::int64_t>(s.truth.index), s.truth.time_ns,
                                corrected_deg(s.truth.first_level_deg, s.truth.raw), s.truth.raw};
    ++into.known;
  }
}

bool truth_book::fits(const packet& sent, std::size_t at) const {
  if (sent.known != sent.count || sent.count > open_.size() - at) return false;
  for (std::size_t i = 0; i < sent.count; ++i) {
    const point& seen = open_[at + i];
    const sample& truth = sent.samples[i];
    if (static_cast<float>(truth.raw) * 0.25F != seen.range_mm) return false;
    if (seen.is_revolution_start() != (sent.zero && i == 0)) return false;
    if (apart_deg(truth.angle_deg, static_cast<double>(seen.angle_deg)) > angle_slack_deg)
      return false;
  }
  return true;
}

/// How surely a packet is the one that was delivered: those of one sample and those that saw nothing
/// look the same a turn later. Then what was delivered behind it decides.
truth_book::likeness truth_book::compare(std::size_t which, std::size_t at) const {
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
/// that may follow is passed over.
truth_book::finding truth_book::find(std::size_t at, bool all) const {
  finding best{};
  for (std::size_t i = 0; i < sent_.size(); ++i) {
    const likeness like = compare(i, at);
    if (like == likeness::none) continue;
    if (like == likeness::sure) return {i, true, false};
    best.waits = best.waits || (like == likeness::open && !all && open_.size() - at < most_open);
    if (!best.packet) best.packet = i;
  }
  return best;
}

/// The first `blind` open points are of damaged packets, those behind them are of packet `found`.
void truth_book::accept(std::size_t found, bool is_sure, std::size_t blind) {
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

/// Takes the first `blind` open points for those of damaged packets that the checksum has let pass: if
/// there is one just there for each packet of points, and what follows is known.
bool truth_book::settle_blind(std::size_t blind) {
  if (blind >= open_.size()) return false;
  const finding found = find(blind, true);
  if (!found.packet) return false;
  const auto end = sent_.begin() + static_cast<std::ptrdiff_t>(*found.packet);
  const auto damaged = std::count_if(sent_.begin(), end, [](const packet& p) { return !p.whole; });
  const auto packets = static_cast<std::ptrdiff_t>((blind + max_samples - 1) / max_samples);
  if (damaged < packets) return false;
  counts_.blind_packets += static_cast<std::uint64_t>(packets);
  accept(*found.packet, found.is_sure, blind);
  return true;
}

/// The first open point is of no packet as it was sent.
bool truth_book::settle_unknown(bool all) {
  for (const packet& sent : sent_) {  // most keep their length
    if (!sent.whole && settle_blind(sent.count)) return true;
  }
  for (std::size_t blind = 1; blind < open_.size(); ++blind) {
    if (settle_blind(blind)) return true;
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

void truth_book::drop_rest_of_packet() {
  is_cut_ = false;
  for (std::size_t rest = 0; rest < std::min(open_.size(), max_samples); ++rest) {
    if (!find(rest, true).packet) continue;
    open_.erase(open_.begin(), open_.begin() + static_cast<std::ptrdiff_t>(rest));
    return;
  }
}

bool truth_book::settle_one(bool all) {
  if (is_cut_) drop_rest_of_packet();
  const finding found = find(0, all);
  if (found.waits) return false;
  if (!found.packet) return settle_unknown(all);
  accept(*found.packet, found.is_sure, 0);
  return true;
}

std::span<const known_point> truth_book::settle(bool all) {
  known_.clear();
  while (!open_.empty() && settle_one(all)) {
  }
  return known_;
}

}  // namespace g4lidar::lives
