// SPDX-License-Identifier: MIT
// Plausibility beyond the checksum: what is found of the errors that it lets through, and what is
// marked without an error, on a simulated lidar behind a line that flips bits.
#include "g4lidar/filter/plausibility.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <optional>
#include <random>
#include <span>
#include <variant>
#include <vector>

#include "../support/packet_maker.hpp"
#include "../support/test_scale.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/sim/scanner.hpp"

namespace g4lidar::test {
namespace {

// ---- a line that flips bits -------------------------------------------------------------------

/// What was sent from byte `offset` on.
struct sent {
  std::uint64_t offset;
  std::vector<std::uint8_t> data;
};

/// The points of both kinds and of all four outcomes.
struct counts {
  std::uint64_t points = 0;
  std::uint64_t wrong = 0;  ///< Their range or angle is not that which was sent.
  std::uint64_t wrong_unmarked = 0;
  std::uint64_t far_unmarked =
      0;  ///< Of these: by more than 100 mm and 6 % of the range, or a degree.
  std::uint64_t right_marked = 0;
};

sim::scanner_options with_noise() {
  sim::scanner_options options;
  options.noise_mm = 4.0;
  options.noise_ratio = 0.003;
  options.dropout_ratio = 0.01;
  return options;
}

class noisy_line {
 public:
  noisy_line(std::uint64_t seed, double flips_per_byte)
      : scanner_(sim::built_in_world(), with_noise()),
        random_(seed),
        gap_(std::max(flips_per_byte, 1e-15)) {
    to_next_flip_ = gap_(random_);
  }

  counts run(std::uint64_t points) {
    while (counts_.points < points) send();
    judge();
    return counts_;
  }

 private:
  void send() {
    const bytes made = scanner_.next().data;
    sent_.push_back({offset_, {made.begin(), made.end()}});
    std::vector<std::uint8_t> data = sent_.back().data;
    while (to_next_flip_ < data.size()) {
      data[static_cast<std::size_t>(to_next_flip_)] ^=
          static_cast<std::uint8_t>(1U << (random_() % 8));
      to_next_flip_ += 1 + gap_(random_);
    }
    to_next_flip_ -= data.size();
    offset_ += data.size();
    bytes rest(data);
    while (const auto found = parser_.next(rest)) take(*found);
    while (sent_.size() > 64) sent_.pop_front();
  }
  void take(const event& found) {
    if (const auto* gone = std::get_if<skipped>(&found)) {
      taken_ += gone->count;
      check_.lost();
      return;
    }
    if (const auto* reply = std::get_if<response_view>(&found)) {
      taken_ += reply->data().size();
      return;
    }
    const packet_view packet = std::get<packet_view>(found);
    const std::uint64_t at = taken_;
    taken_ += packet.data().size();
    take(packet, at);
  }
  void take(packet_view packet, std::uint64_t at) {
    std::array<point, max_samples> memory;
    const decoded got = decode(packet, exact_correction{}, 0, memory);
    const bool fits = check_.fits(packet);
    if (got.points.empty()) return;
    if (!fits) mark_unlikely(std::span(memory).first(got.points.size()));
    const sent* origin = nullptr;
    for (const sent& each : sent_) {
      if (each.offset == at && each.data.size() == packet.data().size()) origin = &each;
    }
    const auto original = origin == nullptr ? std::nullopt : packet_view::from(bytes(origin->data));
    for (std::size_t i = 0; i < got.points.size(); ++i) {
      points_.push_back(memory[i]);
      errors_.push_back(original ? error_of(packet, *original, i) : error::far);
    }
    counts_.points += got.points.size();
    if (points_.size() > 20'000) judge();
  }
  enum class error : std::uint8_t { none, near, far };
  /// An error of the angle by at most 1/32 degree is none: that is twice the rounding.
  static error error_of(packet_view got, packet_view original, std::size_t i) {
    const first_level_angles<double> a(got);
    const first_level_angles<double> b(original);
    const double turned = a.first - b.first + static_cast<double>(i) * (a.step - b.step);
    const double off_deg = std::abs(std::remainder(turned, 360.0));
    const double off = std::abs(got.sample(i) - original.sample(i));
    if (off_deg > 1.0 || off > 400.0 + 0.06 * original.sample(i)) return error::far;
    return off_deg > 1.0 / 32.0 || off > 0.0 ? error::near : error::none;
  }
  void judge() {
    mark_bit_errors(points_);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const bool is_marked = (points_[i].flags & point_flags::unlikely) != point_flags::none;
      const bool is_wrong = errors_[i] != error::none;
      counts_.wrong += is_wrong ? 1U : 0U;
      counts_.wrong_unmarked += is_wrong && !is_marked ? 1U : 0U;
      counts_.far_unmarked += errors_[i] == error::far && !is_marked ? 1U : 0U;
      counts_.right_marked += !is_wrong && is_marked ? 1U : 0U;
    }
    points_.clear();
    errors_.clear();
  }

  sim::scanner scanner_;
  std::mt19937_64 random_;
  std::geometric_distribution<std::uint64_t> gap_;
  std::uint64_t to_next_flip_ = 0;
  std::deque<sent> sent_;
  std::uint64_t offset_ = 0;
  std::uint64_t taken_ = 0;
  stream_parser parser_;
  angle_check check_;
  std::vector<point> points_;
  std::vector<error> errors_;
  counts counts_;
};

// G4LIDAR_TEST_SCALE=200 makes 10^8 points of each.
TEST(Plausibility, BothKindsOfMistake) {
  struct row {
    const char* name;
    double flips_per_byte;
  };
  const auto points = static_cast<std::uint64_t>(scaled(500'000));
  for (const row& each :
       {row{"no flips", 0.0}, row{"1e-3 flips per byte", 1e-3}, row{"1e-2 flips per byte", 1e-2}}) {
    const counts got = noisy_line(7, each.flips_per_byte).run(points);
    std::printf(
        "%-20s %10llu points, %7llu wrong, unmarked %7llu (far off %7llu), right ones marked "
        "%7llu\n",
        each.name, static_cast<unsigned long long>(got.points),
        static_cast<unsigned long long>(got.wrong),
        static_cast<unsigned long long>(got.wrong_unmarked),
        static_cast<unsigned long long>(got.far_unmarked),
        static_cast<unsigned long long>(got.right_marked));
    EXPECT_LE(got.right_marked,
              each.flips_per_byte > 0.0 ? got.points / 500 : got.points / 1'000'000);
    EXPECT_LE(got.far_unmarked, got.points / 500);
    EXPECT_TRUE(got.wrong == 0 || each.flips_per_byte > 0.0);
  }
}

// ---- angle_check -----------------------------------------------------------------------------

/// Packets of 40 samples, one after the other, from 0 degrees on, at 11.25 degrees each.
made::packet turned(int number, int first_off = 0, int last_off = 0) {
  const int first = number * 720 % turn_64ths;
  return {0U, (first + first_off) % turn_64ths, (first + 702 + last_off) % turn_64ths,
          std::size_t{40}};
}

bool fits(angle_check& check, const made::packet& packet) { return check.fits(packet.view()); }

TEST(AngleCheck, OneWrongPacket_DoesNotFit_TheNextOnesDo) {
  struct offsets {
    int first;
    int last;
  };
  for (const auto [first, last] : {offsets{640, 0}, offsets{0, 640}, offsets{640, 640},
                                   offsets{5120, 5120}, offsets{0, 128}, offsets{-64, -64}}) {
    angle_check check;
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(fits(check, (i == 50 ? turned(i, first, last) : turned(i))), i != 50) << i;
    }
  }
}

TEST(AngleCheck, AfterAKnownLoss_OnlyTheTurnIsJudged) {
  angle_check check;
  EXPECT_TRUE(fits(check, turned(0)));
  EXPECT_TRUE(fits(check, turned(1)));
  check.lost();
  EXPECT_FALSE(fits(check, turned(7, 0, 640)));
  EXPECT_TRUE(fits(check, turned(8)));
  EXPECT_FALSE(fits(check, turned(11))) << "a loss of which nobody knows";
  EXPECT_FALSE(fits(check, turned(12))) << "the second one is taken anew";
  EXPECT_TRUE(fits(check, turned(13)));
}

// The speed changes by 1 % per packet, from 5 to 12 revolutions per second and back, with zero
// packets.
TEST(AngleCheck, AMotorThatChangesItsSpeed_Fits) {
  sim::scanner scanner(sim::built_in_world(), {});
  angle_check check;
  double speed_hz = 5.0;
  for (int i = 0; i < 2000; ++i) {
    speed_hz = i % 200 < 88                      ? speed_hz * 1.01
               : i % 200 >= 100 && i % 200 < 188 ? speed_hz / 1.01
                                                 : speed_hz;
    scanner.set_speed_mhz(static_cast<std::uint32_t>(speed_hz * 1000.0));
    EXPECT_TRUE(check.fits(*packet_view::from(scanner.next().data))) << i;
  }
}

// ---- mark_bit_errors -------------------------------------------------------------------------

/// A surface at about this many quarter millimetres, with one sample replaced.
std::vector<point> surface(int raw, int replaced) {
  std::vector<point> points(9);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int each = i == 4 ? replaced : raw == 0 ? 0 : raw + static_cast<int>(i % 3) * 10;
    points[i].range_mm = static_cast<float>(each) * 0.25F;
    points[i].flags = flag_of(static_cast<std::uint16_t>(each));
  }
  return points;
}
bool is_marked(std::vector<point> points) {
  const std::size_t count = mark_bit_errors(points);
  const bool middle = (points[4].flags & point_flags::unlikely) != point_flags::none;
  EXPECT_EQ(count, middle ? 1U : 0U);
  return middle;
}

// At 2 m neighbours may differ by 2 %, 40 mm; an error of less than three times that is not found.
TEST(BitErrors, ASampleWithOneWrongBit_IsMarked_IfItIsFarOff) {
  for (int bit = 0; bit < 16; ++bit) {
    EXPECT_EQ(is_marked(surface(8000, 8000 ^ 1 << bit)), bit >= 9) << bit;
  }
  EXPECT_FALSE(is_marked(surface(8000, 8000)));
  EXPECT_FALSE(is_marked(surface(8000, 0))) << "no return";
  EXPECT_FALSE(is_marked(surface(8000, 8000 - 768))) << "between two bits";
  EXPECT_FALSE(is_marked(surface(8000, 8000 ^ 512 ^ 2048))) << "two bits";
  EXPECT_FALSE(is_marked(surface(8000, 8450))) << "512 more by noise, but that bit is not set";
}

// Where the word of a sample is the range in millimetres, an error of bit 12 is 4.096 m, in half
// millimetres 2.048 m; with flags below the range it is 1.024 m, as with quarter millimetres.
TEST(BitErrors, TheUnitOfTheSamplesDecides) {
  const auto is_marked_at = [](float range_mm, float off_mm, sample_layout layout) {
    std::vector<point> points(9);
    for (point& p : points) p.range_mm = range_mm;
    points[4].range_mm += off_mm;
    return mark_bit_errors(points, {}, layout) == 1;
  };
  using enum sample_layout;
  for (const auto layout : {quarter_mm, flagged_mm, intensity_8, intensity_10}) {
    EXPECT_TRUE(is_marked_at(2000.0F, 8192.0F, layout)) << "bit 15";
    EXPECT_FALSE(is_marked_at(2000.0F, 16'384.0F, layout)) << "no sample contains this";
  }
  EXPECT_TRUE(is_marked_at(2000.0F, 16'384.0F, half_mm)) << "bit 15";
  for (const auto layout : {whole_mm, intensity_16}) {
    EXPECT_TRUE(is_marked_at(2000.0F, 32'768.0F, layout)) << "bit 15";
    EXPECT_TRUE(is_marked_at(2000.0F, 4096.0F, layout)) << "bit 12";
    EXPECT_FALSE(is_marked_at(2000.0F, 4500.0F, layout)) << "between two bits";
  }
}

TEST(BitErrors, BesideAnEdge_NothingIsMarked) {
  std::vector<point> points = surface(8000, 8000 ^ 4096);
  for (std::size_t i = 6; i < points.size(); ++i) points[i].range_mm = 1000.0F;
  EXPECT_FALSE(is_marked(points));
}

TEST(BitErrors, AmongSamplesWithoutReturn_OneBitIsAnError) {
  EXPECT_TRUE(is_marked(surface(0, 4096)));
  EXPECT_FALSE(is_marked(surface(0, 4097)));
}

}  // namespace
}  // namespace g4lidar::test
