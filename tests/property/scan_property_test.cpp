// SPDX-License-Identifier: MIT
// The assembler and a second one, written sample by sample from the protocol and the contract: any
// packets in any order, with losses, in storage of any size.
#include <gtest/gtest.h>
// GoogleTest first.
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/scan_assembler.hpp"
#include "support/check_cases.hpp"
#include "support/packet_maker.hpp"
#include "support/scan_cutter.hpp"

namespace g4lidar {
namespace {

/// A scan of the reference.
struct piece {
  std::size_t points = 0;
  std::size_t suspect = 0;
  scan_flags flags = scan_flags::none;
  double turned = 0.0;  ///< 1/64 degree
};

/// Cuts sample by sample. Keeps for each sample of the scan its distance from the last zero angle,
/// and for each loss the samples before and after it. Uses only the begin of packets.
class reference_cutter {
 public:
  explicit reference_cutter(std::size_t room) : room_(room) {}

  void feed(const made::packet& packet) {
    const bytes wire = packet.data();
    const int first = (wire[4] | wire[5] << 8) / 2;
    const int last = (wire[6] | wire[7] << 8) / 2;
    const bool through_zero = first > 270 * 64 && last < 90 * 64;
    const int way = last < first && through_zero ? last - first + 23040 : last - first;
    if (wire[2] % 2 == 1) {
      if (!samples_.empty()) {
        step_to(first);
        const bool started = (start_ & scan_flags::start_missing) == scan_flags::none;
        give(samples_.size(),
             started && turned_ < 350 * 64 ? scan_flags::turn_short : scan_flags::none);
      } else if (suspect_ > 0) {
        give(0, scan_flags::none);
      }
      samples_.clear();
      losses_.clear();
      start_ = scan_flags::none;
      turned_ = 0.0;
      at_ = first;
    }
    if (way < 0) {
      ++suspect_;
      lose();
      return;
    }
    for (int i = 0; i < wire[3]; ++i) {
      const double inside = std::floor(static_cast<double>(way) * i / std::max(wire[3] - 1, 1));
      if (i == 0) {
        step_to(first);
      } else {
        turned_ += first + inside - at_;
        at_ = first + inside;
      }
      if (turned_ > 361 * 64 || samples_.size() == room_) cut();
      samples_.push_back(turned_);
    }
  }
  void lose() { losses_.push_back(samples_.size()); }
  void finish() {
    if (samples_.size() + suspect_ > 0) give(samples_.size(), scan_flags::end_missing);
  }

  std::vector<piece> pieces;

 private:
  void step_to(double angle) {
    if (at_ < 0.0) at_ = angle;
    double step = std::fmod(angle - at_ + 2 * 23040, 23040);
    if (step > 315 * 64) step -= 23040;
    turned_ = std::max(turned_ + step, -23040.0);
    at_ = std::fmod(angle, 23040);
  }
  void cut() {
    if (turned_ < 360 * 64) {
      give(samples_.size(), scan_flags::end_missing);
      start_ = scan_flags::start_missing;
      return;
    }
    std::size_t end = samples_.size();
    while (end > 0 && samples_[end - 1] >= 360 * 64) --end;
    give(end, scan_flags::end_by_angle);
    start_ = scan_flags::start_by_angle;
    for (double& each : samples_) each -= 23040;
    turned_ -= 23040;
  }
  /// The first `count` samples are a scan; a loss directly at its end belongs to the next one, too.
  void give(std::size_t count, scan_flags end) {
    const double next = count < samples_.size() ? samples_[count] : turned_;
    piece made{count, suspect_, start_ | end, 0.0};
    if (!samples_.empty()) made.turned = next - samples_.front();
    std::vector<std::size_t> later;
    for (const std::size_t place : losses_) {
      if (place <= count) made.flags = made.flags | scan_flags::data_lost;
      const bool is_next = end == scan_flags::end_by_angle && place >= count && place > 0;
      if (is_next) later.push_back(place - count);
    }
    pieces.push_back(made);
    losses_ = later;
    samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(count));
    suspect_ = 0;
  }

  std::size_t room_;
  scan_flags start_ = scan_flags::start_missing;
  std::size_t suspect_ = 0;
  std::vector<double> samples_;
  std::vector<std::size_t> losses_;  ///< The number of samples before each.
  double turned_ = 0.0;              ///< From the last zero angle, 1/64 degree.
  double at_ = -1.0;                 ///< First-level angle of the last sample, 1/64 degree.
};

/// A packet is made from a kind and a number.
using recipe = std::pair<std::uint8_t, std::uint32_t>;

/// The position of the scanner; packets continue from there, approximately.
class scanner {
 public:
  std::optional<made::packet> next(const recipe& what) {
    const int number = static_cast<int>(what.second % 1'000'000);
    const auto samples = static_cast<std::size_t>(1 + number % 80);
    switch (what.first % 12) {
      case 0:  // a zero packet at any place
        return made::packet(1U | static_cast<unsigned>(number % 128) << 1, at_, at_, 1);
      case 1:  // a zero packet with samples, the last of which may be before the first
        return on(1, number % 500 - 100, samples);
      case 2:  // anything
        at_ = number % 23040;
        return made::packet(static_cast<unsigned>(number % 128) << 1, at_, number / 7 % 23040,
                            samples);
      case 3:  // not turning
        return made::packet(0, at_, at_, samples);
      case 4:  // a gap
        at_ = (at_ + number % 23040) % 23040;
        return on(0, number % 1300, samples);
      case 5:  // a little back
        at_ = (at_ + 23040 - number % 3000) % 23040;
        return on(0, number % 1300, samples);
      case 6:
        return std::nullopt;  // bytes are lost
      default:                // turning normally
        at_ = (at_ + 30) % 23040;
        return on(0x86, 600 + number % 2000, samples);
    }
  }

 private:
  made::packet on(unsigned ct, int way, std::size_t samples) {
    const int first = at_;
    at_ = (at_ + way + 23040) % 23040;
    return made::packet(ct, first, at_, samples);
  }

  int at_ = 0;
};

void expect_same(const test::kept_scan& got, const piece& expected) {
  RC_ASSERT(got.points.size() == expected.points);
  RC_ASSERT(got.view.suspect_packets == expected.suspect);
  RC_ASSERT(got.view.flags == expected.flags);
  RC_ASSERT(std::fabs(static_cast<double>(got.view.turned_deg) * 64.0 - expected.turned) < 0.5);
}

TEST(ScanProperty, PointsAreCompleteAndInOrder_CutsAgreeWithTheReference) {
  test::check_cases(1500, [] {
    const auto recipes = *rc::gen::scale(3.0, rc::gen::arbitrary<std::vector<recipe>>());
    const auto room = *rc::gen::element<std::size_t>(1, 2, 7, 79, 80, 81, 500, 3000);
    test::scan_cutter cutter(room);
    reference_cutter expected(room);
    scanner device;
    for (const recipe& what : recipes) {
      if (const auto packet = device.next(what)) {
        cutter.feed(packet->view());
        expected.feed(*packet);
      } else {
        cutter.lost();
        expected.lose();
      }
    }
    cutter.finish();
    expected.finish();
    RC_ASSERT(cutter.came_out() == cutter.put_in());
    RC_ASSERT(cutter.scans().size() == expected.pieces.size());
    for (std::size_t i = 0; i < expected.pieces.size(); ++i) {
      const test::kept_scan& got = cutter.scans()[i];
      expect_same(got, expected.pieces[i]);
      // All points of a scan belong to its revolution, and it contains no other zero packet.
      for (std::size_t k = 0; k < got.points.size(); ++k) {
        RC_ASSERT(got.points[k].revolution == got.view.revolution);
        RC_ASSERT(k == 0 || !got.points[k].is_revolution_start());
      }
    }
    RC_CLASSIFY(expected.pieces.size() > 3);
  });
}

}  // namespace
}  // namespace g4lidar
