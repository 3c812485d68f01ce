// SPDX-License-Identifier: MIT
// Passes packets to the assembler, and stores the scans.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/scan_assembler.hpp"

namespace g4lidar::test {

/// A scan with points of its own, which `view.points` refers to. Can be moved, not copied.
struct kept_scan {
  scan view;
  std::vector<point> points;
};

/// Feeds an assembler like a program, and stores its scans.
class scan_cutter {
 public:
  explicit scan_cutter(std::size_t room) : storage_(room), assembler_(storage_) {}
  scan_cutter(const scan_cutter&) = delete;
  scan_cutter& operator=(const scan_cutter&) = delete;

  /// Points get the times `time_ns`, `time_ns + step_ns` and so on, or 0 if `time_ns` is 0.
  void feed(packet_view packet, std::int64_t time_ns = 0, std::int64_t step_ns = 0) {
    std::array<point, max_samples> out;
    decoded now = decode(packet, compact_correction{}, revolutions_.count(packet), out);
    for (std::size_t i = 0; i < now.points.size() && time_ns != 0; ++i) {
      out[i].time_ns = time_ns + static_cast<std::int64_t>(i) * step_ns;
    }
    put_in_.insert(put_in_.end(), now.points.begin(), now.points.end());
    while (const std::optional<scan> found = assembler_.next(now)) keep(*found);
  }
  void add(skipped gone) { assembler_.add(gone); }
  void lost() { assembler_.lost(); }
  void crc_mismatch() { assembler_.crc_mismatch(); }
  void set_sample_rate(std::uint32_t hz) { assembler_.set_sample_rate(hz); }
  void finish() {
    while (const std::optional<scan> found = assembler_.finish()) keep(*found);
  }

  [[nodiscard]] const std::vector<kept_scan>& scans() const { return scans_; }
  /// All points so far, in input order.
  [[nodiscard]] const std::vector<point>& put_in() const { return put_in_; }
  /// All points of all scans so far, one after the other.
  [[nodiscard]] std::vector<point> came_out() const {
    std::vector<point> all;
    for (const kept_scan& kept : scans_) {
      all.insert(all.end(), kept.points.begin(), kept.points.end());
    }
    return all;
  }

 private:
  void keep(const scan& found) {
    scans_.push_back({found, {found.points.begin(), found.points.end()}});
    scans_.back().view.points = scans_.back().points;
  }

  std::vector<point> storage_;
  scan_assembler assembler_;
  revolution_counter revolutions_;
  std::vector<kept_scan> scans_;
  std::vector<point> put_in_;
};

}  // namespace g4lidar::test
