// SPDX-License-Identifier: MIT
// Angles wrap on both sides and for many turns, are never 360, and have exact enough sines.
#include "g4lidar/core/angle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

namespace g4lidar {
namespace {

template <class T>
concept ordered = requires(T a, T b) { a < b; };
static_assert(!ordered<angle>);
static_assert(!std::totally_ordered<angle>);
static_assert(std::equality_comparable<angle>);

static_assert(angle::from_degrees(-90.0F).degrees() == 270.0F);
static_assert(angle::from_degrees(360.0F).degrees() == 0.0F);
static_assert(angle::from_degrees(-360.0F) == angle{});
static_assert(angle::from_degrees(350.0F) + angle::from_degrees(20.0F) ==
              angle::from_degrees(10.0F));
static_assert(angle::from_degrees(10.0F) - angle::from_degrees(20.0F) ==
              angle::from_degrees(350.0F));
static_assert(angle::from_degrees(350.0F).forward_to(angle::from_degrees(10.0F)) == 20.0F);
static_assert(angle::from_degrees(10.0F).forward_to(angle::from_degrees(350.0F)) == 340.0F);
static_assert(angle::from_degrees(10.0F).apart_from(angle::from_degrees(350.0F)) == 20.0F);
static_assert(angle::from_degrees(350.0F).apart_from(angle::from_degrees(10.0F)) == 20.0F);
static_assert((-angle::from_degrees(90.0F)).degrees() == 270.0F);
static_assert(angle::from_degrees(180.0F).signed_degrees() == -180.0F);
static_assert(angle::from_degrees(179.0F).signed_degrees() == 179.0F);

template <class Real>
void expect_wrapped(Real degrees) {
  const Real once = wrap_once_deg(degrees);
  EXPECT_GE(once, Real(0)) << degrees;
  EXPECT_LT(once, Real(360)) << degrees;
  const double turns = (static_cast<double>(degrees) - static_cast<double>(once)) / 360.0;
  EXPECT_NEAR(turns, std::round(turns), 1e-7) << degrees;
}

template <class Real>
void expect_wrapped_on_both_sides() {
  const Real tiny = std::numeric_limits<Real>::denorm_min();
  for (const Real near : {Real(-360), Real(-180), Real(0), Real(180), Real(360), Real(540)}) {
    Real below = near;
    Real above = near;
    for (int i = 0; i < 20; ++i) {
      below = std::nextafter(below, Real(-1000));
      above = std::nextafter(above, Real(1000));
      if (below >= Real(-360)) expect_wrapped(below);
      expect_wrapped(above);
    }
    expect_wrapped(near);
  }
  expect_wrapped(tiny);
  expect_wrapped(-tiny);
  expect_wrapped(Real(-1e-20));
  expect_wrapped(-std::numeric_limits<Real>::epsilon());
  expect_wrapped(std::nextafter(Real(720), Real(0)));
  for (int i = -36000; i < 72000; ++i) expect_wrapped(static_cast<Real>(i) / Real(100));
}

TEST(Angle, WrapsOnBothSidesAndIsNever360) {
  expect_wrapped_on_both_sides<float>();
  expect_wrapped_on_both_sides<double>();
}

TEST(Angle, WrapsManyTurnsExactly) {
  for (const float degrees :
       {720.0F, -720.0F, 1e6F, -1e6F, 1.3e8F, 3e9F, -3e9F, 1e10F, -1e12F, 9.9e14F, -9.9e14F}) {
    double wanted = std::fmod(static_cast<double>(degrees), 360.0);
    if (wanted < 0) wanted += 360.0;
    EXPECT_EQ(static_cast<double>(wrap_deg(degrees)), wanted) << degrees;
    EXPECT_EQ(wrap_deg(static_cast<double>(degrees)), wanted) << degrees;
    EXPECT_EQ(angle::from_degrees(degrees).degrees(), static_cast<float>(wanted));
  }
  EXPECT_NEAR(wrap_deg(1234567.625), 127.625, 1e-9);
  EXPECT_NEAR(wrap_deg(-1234567.625), 360.0 - 127.625, 1e-9);
}

TEST(Angle, MinusZeroEqualsZero) {
  EXPECT_EQ((-angle{}).degrees(), 0.0F);
  EXPECT_FALSE(std::signbit((-angle{}).degrees()));
  EXPECT_FALSE(std::signbit(angle::from_degrees(-0.0F).degrees()));
  EXPECT_FALSE(std::signbit(angle::from_degrees(-360.0F).degrees()));
  EXPECT_FALSE(std::signbit(wrap_once_deg(-0.0F)));
}

TEST(Angle, SumsAndDifferencesWrap) {
  for (int a = 0; a < 360; a += 7) {
    for (int b = 0; b < 360; b += 11) {
      const angle x = angle::from_degrees(static_cast<float>(a));
      const angle y = angle::from_degrees(static_cast<float>(b));
      EXPECT_EQ((x + y).degrees(), static_cast<float>((a + b) % 360));
      EXPECT_EQ((x - y).degrees(), static_cast<float>((a - b + 360) % 360));
      EXPECT_EQ(y.forward_to(x), static_cast<float>((a - b + 360) % 360));
      EXPECT_EQ(x.apart_from(y), y.apart_from(x));
      EXPECT_LE(x.apart_from(y), 180.0F);
      EXPECT_EQ((x - y) + y, x);
      EXPECT_EQ(x + -x, angle{});
    }
  }
  const angle almost = angle::from_degrees(std::nextafter(360.0F, 0.0F));
  EXPECT_LT((almost + almost).degrees(), 360.0F);
  EXPECT_LT((angle{} - angle::from_degrees(1e-30F)).degrees(), 360.0F);
}

TEST(Angle, ConvertsRadians) {
  EXPECT_FLOAT_EQ(angle::from_degrees(90.0F).radians(), std::numbers::pi_v<float> / 2);
  EXPECT_FLOAT_EQ(angle::from_degrees(270.0F).radians(), -std::numbers::pi_v<float> / 2);
  EXPECT_EQ(angle::from_degrees(180.0F).radians(), -std::numbers::pi_v<float>);
  EXPECT_LT(angle::from_degrees(std::nextafter(180.0F, 0.0F)).radians(), std::numbers::pi_v<float>);
  EXPECT_NEAR(angle::from_radians(1.0F).degrees(), 57.29578F, 1e-5F);
  EXPECT_NEAR(angle::from_radians(-1.0F).degrees(), 302.70422F, 1e-4F);
}

TEST(Angle, SineAndCosineWithinTheirStatedError) {
  double worst = 0;
  for (int i = 0; i < 360 * 1024; ++i) {
    const float degrees = static_cast<float>(i) / 1024.0F;
    const double radians = static_cast<double>(degrees) * (std::numbers::pi / 180.0);
    const sine_cosine got = sine_cosine_deg(degrees);
    worst = std::max(worst, std::abs(static_cast<double>(got.sine) - std::sin(radians)));
    worst = std::max(worst, std::abs(static_cast<double>(got.cosine) - std::cos(radians)));
  }
  EXPECT_LT(worst, 1.2e-7);
  EXPECT_EQ(sine_cosine_deg(0.0F).sine, 0.0F);
  EXPECT_EQ(sine_cosine_deg(90.0F).cosine, 0.0F);
  EXPECT_EQ(sine_cosine_deg(180.0F).cosine, -1.0F);
  EXPECT_EQ(sine_cosine_deg(270.0F).sine, -1.0F);
}

}  // namespace
}  // namespace g4lidar
