// SPDX-License-Identifier: MIT
// From a packet to points: the packet of the manual, both sides of the wrap, rounding, flags,
// revolutions.
#include "g4lidar/core/decode.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "support/packet_maker.hpp"
#include "support/reference_points.hpp"

namespace g4lidar {
namespace {

using storage = std::array<point, max_samples>;

const table_correction& table() {
  static const auto made = std::make_unique<table_correction>();
  return *made;
}

constexpr bool near(float a, double b, double bound) {
  const double off = static_cast<double>(a) - b;
  return off < bound && -off < bound;
}

// The packet of the manual with 40 samples, from 1000 mm to 8000 mm; those between have no return.
constexpr made::packet manual_packet() {
  made::packet made(0, 0x6FE5 >> 1, 0x79BD >> 1, 0x28);
  return made.set(0, 4 * 1000).set(39, 4 * 8000);
}

template <class Form>
constexpr bool decodes_the_manuals_packet(const Form& form) {
  const made::packet packet = manual_packet();
  storage out{};
  const decoded got = decode(packet.view(), form, 7, out);
  const point& first = got.points.front();
  const point& last = got.points.back();
  return got.points.size() == 40 && got.points.data() == out.data() && got.revolution == 7 &&
         got.sample_count == 40 && got.first_angle_64ths == 14322 && got.span_64ths == 1260 &&
         !got.starts_revolution && !got.suspect && got.reported_frequency_chz == 0 &&
         near(first.angle_deg, 217.019064, 3e-5) && near(last.angle_deg, 235.631325, 3e-5) &&
         near(first.angle_deg, 217.0178, 0.0014) && near(last.angle_deg, 235.6326, 0.0014) &&
         first.range_mm == 1000.0F && last.range_mm == 8000.0F && last.revolution == 7 &&
         last.time_ns == 0 && first.flags == point_flags::none &&
         got.points[1].flags == point_flags::no_return && got.points[1].range_mm == 0.0F &&
         near(got.points[1].angle_deg, 223.78125 + 19.6875 / 39 - 7.9905963, 3e-5);
}
static_assert(decodes_the_manuals_packet(exact_correction{}));
static_assert(decodes_the_manuals_packet(compact_correction{}));

TEST(Decode, GivesTheManualsPacket) {
  EXPECT_TRUE(decodes_the_manuals_packet(exact_correction{}));
  EXPECT_TRUE(decodes_the_manuals_packet(compact_correction{}));
  EXPECT_TRUE(decodes_the_manuals_packet(table()));
}

TEST(Decode, GivesTheManualsRange) {
  const made::packet packet = made::zero(0, 0x6FE5);
  storage out;
  EXPECT_EQ(decode(packet.view(), table(), 0, out).points[0].range_mm, 7161.25F);
}

/// Decodes and compares every point with the reference, within `bound` degrees.
template <class Form>
void expect_like_reference(const made::packet& packet, const Form& form, double bound) {
  storage out;
  const decoded got = decode(packet.view(), form, 3, out);
  const std::vector<reference::sample> expected = reference::samples_of(packet.data());
  ASSERT_EQ(got.points.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const point& p = got.points[i];
    ASSERT_GE(p.angle_deg, 0.0F);
    ASSERT_LT(p.angle_deg, 360.0F);
    ASSERT_LE(reference::apart_deg(static_cast<double>(p.angle_deg), expected[i].angle_deg), bound)
        << "raw " << expected[i].raw << " at " << expected[i].first_level_deg;
    ASSERT_LE(
        reference::apart_deg(static_cast<double>(raw_angle_deg(p)), expected[i].first_level_deg),
        bound + 1e-4);
    ASSERT_LT(raw_angle_deg(p), 360.0F);
    ASSERT_EQ(static_cast<double>(p.range_mm), expected[i].range_mm);
    ASSERT_EQ(p.is_no_return(), expected[i].range_mm == 0.0);
    ASSERT_EQ(p.is_too_near(), expected[i].range_mm > 0.0 && expected[i].range_mm < 100.0);
    ASSERT_EQ(p.revolution, 3U);
    ASSERT_EQ(p.time_ns, 0);
  }
}

void expect_all_forms_like_reference(const made::packet& packet) {
  // A result below 360 in single precision is rounded by up to 1.6e-5 degrees.
  expect_like_reference(packet, exact_correction{}, 1.6e-5);
  expect_like_reference(packet, table(), 1e-4);
  expect_like_reference(packet, compact_correction{}, 1e-4);
}

// Samples with every size of correction, from +89 to -8 degrees.
std::vector<std::uint16_t> distinct_samples(std::size_t count) {
  std::vector<std::uint16_t> raw(count);
  for (std::size_t i = 0; i < count; ++i) {
    raw[i] = static_cast<std::uint16_t>(i * i * i * 65535 / (79 * 79 * 79));
  }
  return raw;
}

TEST(Decode, AgreesWithReferenceAroundTheCircle) {
  for (int first = 0; first < 23040; first += 479) {
    for (const int span : {0, 1, 79, 1260, 5000}) {
      const int last = first + span;
      if (last >= 23040 && !(first > 270 * 64 && last - 23040 < 90 * 64)) continue;
      const std::vector<std::uint16_t> raw = distinct_samples(80);
      expect_all_forms_like_reference(made::packet(0, first, last % 23040, raw));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Decode, WrapsOnBothSidesOfZero) {
  for (int angle = 0; angle < 100 * 64; angle += 7) {
    const made::packet above = made::packet(0, angle, angle, distinct_samples(40));
    const made::packet below = made::packet(0, 23039 - angle, 23039 - angle, distinct_samples(40));
    expect_all_forms_like_reference(above);
    expect_all_forms_like_reference(below);
    if (HasFatalFailure()) return;
  }
  // A wrap within the packet, like a real one directly after a zero packet.
  expect_all_forms_like_reference(made::packet(0, 23000, 40, distinct_samples(80)));
  expect_all_forms_like_reference(made::packet(0, 270 * 64 + 1, 90 * 64 - 1, distinct_samples(80)));
}

TEST(Decode, PacketAcrossTheCircle_IsDecodedCompletely) {
  expect_all_forms_like_reference(made::packet(0, 0, 23039, distinct_samples(80)));
}

TEST(Decode, OneSampleHasTheFirstAngle) {
  for (const int angle : {0, 1, 500, 22272, 23039}) {
    for (const unsigned raw : {0U, 1U, 4U, 4000U, 65535U}) {
      expect_all_forms_like_reference(made::zero(angle, static_cast<std::uint16_t>(raw)));
    }
  }
  // FSA and LSA differ although there is one sample: no division by 0.
  made::packet packet(0, 6400, 6464, 1);
  expect_all_forms_like_reference(packet.set(0, 4000));
}

TEST(Decode, StoppedMotor_GivesOneFirstLevelAngle) {
  for (const std::size_t count : {4U, 40U, 80U}) {
    const std::vector<std::uint16_t> raw(count, 8000);
    const made::packet packet(0, 6400, 6400, raw);
    storage out;
    const decoded got = decode(packet.view(), table(), 0, out);
    ASSERT_EQ(got.points.size(), count);
    EXPECT_EQ(got.span_64ths, 0);
    EXPECT_NEAR(got.points[0].angle_deg, 100.0F - 7.3772F, 0.001F);
    for (const point& p : got.points) EXPECT_EQ(p.angle_deg, got.points[0].angle_deg);
  }
}

TEST(Decode, WritesExactlyTheSamplesOfThePacket) {
  for (std::size_t count = 1; count <= max_samples; ++count) {
    storage out;
    const point untouched{-1.0F, -1.0F, -1, 99, point_flags::too_near, {}};
    out.fill(untouched);
    const made::packet packet(0, 100, 1360, distinct_samples(count));
    const decoded got = decode(packet.view(), table(), 3, out);
    ASSERT_EQ(got.points.size(), count);
    ASSERT_EQ(got.sample_count, count);
    ASSERT_TRUE(std::all_of(out.begin() + static_cast<std::ptrdiff_t>(count), out.end(),
                            [&](const point& p) { return p == untouched; }));
    expect_all_forms_like_reference(packet);
  }
}

/// A sample whose corrected angle is slightly below 0: sample `i` of `count` in a packet from
/// `first` to one step further.
struct hair {
  std::uint16_t raw;
  int first;
  std::size_t i;
  std::size_t count;
};

/// Samples for which first-level angle plus correction is in (-`width`, 0) degrees.
std::vector<hair> hairs_below_zero(double width, std::size_t at_most) {
  std::vector<hair> found;
  for (unsigned raw = 622; raw <= 65535 && found.size() < at_most; ++raw) {
    const double wanted = -reference::correction_deg(static_cast<std::uint16_t>(raw)) * 64.0;
    const int first = static_cast<int>(wanted);
    for (std::size_t gaps = 1; gaps < max_samples; ++gaps) {
      const auto i = static_cast<std::size_t>((wanted - first) * static_cast<double>(gaps));
      const double sum = first + static_cast<double>(i) / static_cast<double>(gaps) - wanted;
      if (sum < 0.0 && sum > -width * 64.0) {
        found.push_back({static_cast<std::uint16_t>(raw), first, i, gaps + 1});
        break;
      }
    }
  }
  return found;
}

TEST(Decode, RoundingNearZero_IsNever360) {
  // In single precision all of (-1.5e-5, 0) plus 360 is 360.
  for (const double width : {1e-6, 1.5e-5}) {
    const std::vector<hair> hairs = hairs_below_zero(width, 300);
    ASSERT_GE(hairs.size(), 20U);
    for (const hair& h : hairs) {
      made::packet packet(0, h.first, h.first + 1, h.count);
      packet.set(h.i, h.raw);
      expect_all_forms_like_reference(packet);  // requires [0, 360)
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Decode, SuspectPacket_GivesNoPoints) {
  for (const unsigned ct : {0U, 1U}) {
    const made::packet packet(ct | 70U << 1, 6400, 6390, distinct_samples(40));
    ASSERT_TRUE(packet.view().is_suspect());
    storage out;
    const point untouched{-1.0F, -1.0F, -1, 99, point_flags::too_near, {}};
    out.fill(untouched);
    const decoded got = decode(packet.view(), table(), 5, out);
    EXPECT_TRUE(got.points.empty());
    EXPECT_TRUE(got.suspect);
    EXPECT_EQ(got.starts_revolution, ct == 1U);
    EXPECT_EQ(got.reported_frequency_chz, ct == 1U ? 700 : 0);
    EXPECT_EQ(got.revolution, 5U);
    EXPECT_EQ(got.sample_count, 40);
    EXPECT_TRUE(
        std::all_of(out.begin(), out.end(), [&](const point& p) { return p == untouched; }));
  }
}

TEST(Decode, Suspect_IsBackwardsUnlessThroughZero) {
  const auto suspect = [](int first, int last) {
    const made::packet packet(0, first, last, 2);
    storage out;
    return decode(packet.view(), compact_correction{}, 0, out).suspect;
  };
  EXPECT_FALSE(suspect(270 * 64 + 1, 90 * 64 - 1));
  EXPECT_TRUE(suspect(270 * 64, 90 * 64 - 1));
  EXPECT_TRUE(suspect(270 * 64 + 1, 90 * 64));
  EXPECT_FALSE(suspect(100, 100));
  EXPECT_TRUE(suspect(100, 99));
  EXPECT_FALSE(suspect(0, 23039));
  EXPECT_FALSE(suspect(23039, 0));
}

TEST(Decode, FlagsByRange) {
  static_assert(flag_of(0) == point_flags::no_return);
  static_assert(flag_of(3) == point_flags::no_return);
  static_assert(flag_of(4) == point_flags::too_near);
  static_assert(flag_of(399) == point_flags::too_near);
  static_assert(flag_of(400) == point_flags::none);
  static_assert(flag_of(65535) == point_flags::none);
  for (unsigned raw = 4; raw <= 65535; ++raw) {
    const bool near = raw / 4.0 < 100.0;
    ASSERT_EQ(flag_of(static_cast<std::uint16_t>(raw)),
              near ? point_flags::too_near : point_flags::none);
  }
}

TEST(Decode, SamplesWithFlagsOnly_AreNoReturns) {
  made::packet packet(0, 6400, 6592, 4);  // 100 to 103 degrees
  for (std::size_t i = 0; i < 4; ++i) packet.set(i, static_cast<std::uint16_t>(i));
  const auto expect_no_returns = [&](const auto& form) {
    storage out;
    const decoded got = decode(packet.view(), form, 0, out);
    ASSERT_EQ(got.points.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(got.points[i].flags, point_flags::no_return) << i;
      EXPECT_EQ(got.points[i].range_mm, 0.0F) << i;
      EXPECT_NEAR(got.points[i].angle_deg, 92.0094F + static_cast<float>(i), 1e-4F) << i;
    }
  };
  expect_no_returns(exact_correction{});
  expect_no_returns(compact_correction{});
  expect_no_returns(table());
}

TEST(Decode, FirstSampleOfAZeroPacketStartsTheRevolution) {
  const made::packet zero(1, 100, 200, distinct_samples(3));
  storage out;
  const decoded got = decode(zero.view(), table(), 0, out);
  EXPECT_TRUE(got.starts_revolution);
  EXPECT_TRUE(got.points[0].is_revolution_start());
  EXPECT_TRUE(got.points[0].is_no_return());  // one flag does not hide the other
  EXPECT_FALSE(got.points[1].is_revolution_start());
  EXPECT_FALSE(got.points[2].is_revolution_start());
  const made::packet other(0x86, 100, 200, distinct_samples(3));
  EXPECT_FALSE(decode(other.view(), table(), 0, out).points[0].is_revolution_start());
}

TEST(Decode, FrequencyIsReportedByZeroPacketsOnly) {
  storage out;
  const made::packet zero = made::zero(0, 4000, 103);
  EXPECT_EQ(decode(zero.view(), table(), 0, out).reported_frequency_chz, 1030);
  const made::packet silent = made::zero(0, 4000, 0);
  EXPECT_EQ(decode(silent.view(), table(), 0, out).reported_frequency_chz, 0);
  const made::packet debug(0x86, 0, 64, 2);
  EXPECT_EQ(decode(debug.view(), table(), 0, out).reported_frequency_chz, 0);
}

TEST(RevolutionCounter, StartsAtZeroAndCountsLaterZeroPackets) {
  const made::packet other(0x86, 0, 64, 2);
  const made::packet zero = made::zero(0);
  revolution_counter late;  // the stream begins in the middle of a revolution
  EXPECT_EQ(late.count(other.view()), 0U);
  EXPECT_EQ(late.count(other.view()), 0U);
  EXPECT_EQ(late.count(zero.view()), 1U);
  EXPECT_EQ(late.count(other.view()), 1U);
  EXPECT_EQ(late.count(zero.view()), 2U);
  EXPECT_EQ(late.count(zero.view()), 3U);
  revolution_counter punctual;  // the stream begins with a zero packet
  EXPECT_EQ(punctual.count(zero.view()), 0U);
  EXPECT_EQ(punctual.count(other.view()), 0U);
  EXPECT_EQ(punctual.count(zero.view()), 1U);
}

TEST(RevolutionCounter, CountsSuspectPackets) {
  const made::packet suspect_zero(1, 6400, 6390, 4);
  ASSERT_TRUE(suspect_zero.view().is_suspect());
  revolution_counter revolutions;
  EXPECT_EQ(revolutions.count(suspect_zero.view()), 0U);
  EXPECT_EQ(revolutions.count(suspect_zero.view()), 1U);
}

// Properties that programs may rely on when they store or pass points.
static_assert(sizeof(point) == 24 && alignof(point) == alignof(std::int64_t));
static_assert(std::is_trivially_copyable_v<point>);
static_assert(sizeof(float) * 2 + 8 + 4 + 1 + 3 == sizeof(point), "no padding");

}  // namespace
}  // namespace g4lidar
