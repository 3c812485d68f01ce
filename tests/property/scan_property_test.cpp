// SPDX-License-Identifier: MIT
// The assembler against a second one, written sample by sample from the protocol and the contract:
// any packets in any order, with losses, in storage of any size.
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

#include "g4lidar/packet.hpp"
#include "g4lidar/scan.hpp"
#include "support/check_cases.hpp"
#include "support/packet_maker.hpp"
#include "support/scan_cutter.hpp"

namespace g4lidar {
namespace {

/// What the reference says of a scan.
struct piece {
  std::size_t points = 0;
  std::size_t suspect = 0;
  bool started = false;
  bool ended = false;
  bool lost = false;
  bool is_short = false;
  double turned = 0.0;  ///< 1/64 degree
  double at = 0.0;      ///< First-level angle of the last sample, 1/64 degree, not wrapped.
};

/// Cuts sample by sample. Knows nothing of packets but where they begin.
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
      if (now_.points + now_.suspect > 0) {
        if (now_.points > 0) step_to(first);
        now_.ended = true;
        now_.is_short = now_.started && now_.points > 0 && now_.turned < 350 * 64;
        pieces.push_back(now_);
      }
      now_ = {};
      now_.started = true;
    }
    if (way < 0) {
      ++now_.suspect;
      now_.lost = true;
      return;
    }
    for (int i = 0; i < wire[3]; ++i) {
      const double inside = std::floor(static_cast<double>(way) * i / std::max(wire[3] - 1, 1));
      if (now_.points == 0) now_.at = first + inside;
      if (i == 0) {
        step_to(first);
      } else {
        now_.turned += first + inside - now_.at;
        now_.at = first + inside;
      }
      if (now_.points == room_ || now_.turned > 361 * 64) {
        pieces.push_back(now_);
        now_ = {};
        now_.at = first + inside;
      }
      ++now_.points;
    }
  }
  void lose() { now_.lost = true; }
  void finish() {
    if (now_.points + now_.suspect > 0) pieces.push_back(now_);
    now_ = {};
  }

  std::vector<piece> pieces;

 private:
  void step_to(double angle) {
    double step = std::fmod(angle - now_.at + 2 * 23040, 23040);
    if (step > 315 * 64) step -= 23040;
    now_.turned = std::max(now_.turned + step, -23040.0);
    now_.at = angle;
  }

  std::size_t room_;
  piece now_;
};

/// A packet is made from what it is and from a number.
using recipe = std::pair<std::uint8_t, std::uint32_t>;

/// Where the scanner is; packets go on from there, more or less.
class scanner {
 public:
  std::optional<made::packet> next(const recipe& what) {
    const int number = static_cast<int>(what.second % 1'000'000);
    const auto samples = static_cast<std::size_t>(1 + number % 80);
    switch (what.first % 12) {
      case 0:  // a zero packet wherever it happens
        return made::packet(1U | static_cast<unsigned>(number % 128) << 1, at_, at_, 1);
      case 1:  // a zero packet with samples, the last of which may lie before the first
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
      default:                // turning well
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
  RC_ASSERT(got.view.has(scan_marks::start_missing) == !expected.started);
  RC_ASSERT(got.view.has(scan_marks::end_missing) == !expected.ended);
  RC_ASSERT(got.view.has(scan_marks::data_lost) == expected.lost);
  RC_ASSERT(got.view.has(scan_marks::turn_short) == expected.is_short);
  RC_ASSERT(std::fabs(static_cast<double>(got.view.turned_deg) * 64.0 - expected.turned) < 0.5);
}

TEST(ScanProperty, EveryPointComesOutOnceInOrderAndCutsAreTheReferences) {
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
      // All points of a scan are of its revolution, and no zero packet but its own is in it.
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
