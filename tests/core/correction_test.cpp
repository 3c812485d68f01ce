// SPDX-License-Identifier: MIT
// The second-level correction: the values of the manual, and the largest error of each form over
// all samples, compared with the formula of the manual.
#include "g4lidar/core/correction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>

#include "g4lidar/point.hpp"
#include "support/reference_points.hpp"

namespace g4lidar {
namespace {

constexpr bool near(double a, double b, double bound) { return a - b < bound && b - a < bound; }

// The values of the manual, with its digits, in each form.
struct figure {
  double range_mm;
  double correction_deg;
  double printed_to;
};
constexpr figure figures[] = {{1.0, 87.36, 0.005},      {10.0, 63.88, 0.005},
                              {155.3, 0.0, 0.02},       {280.0, -3.577, 0.0005},
                              {1000.0, -6.762, 0.0005}, {8000.0, -7.837425, 0.0000005},
                              {16000.0, -7.914, 0.0005}};

template <class Form>
constexpr bool gives_the_figures(const Form& form, double rounding) {
  return std::all_of(std::begin(figures), std::end(figures), [&](const figure& f) {
    const auto raw = static_cast<std::uint16_t>(f.range_mm * 4.0);
    return near(static_cast<double>(form(raw)), f.correction_deg, f.printed_to + rounding);
  });
}
static_assert(gives_the_figures(exact_correction{}, 0.0));
static_assert(gives_the_figures(compact_correction{}, 2e-5));

// 155.3 mm is between two samples: the correction changes its sign there.
static_assert(exact_correction{}(621) > 0.0 && exact_correction{}(622) < 0.0);
static_assert(compact_correction{}(621) > 0.0F && compact_correction{}(622) < 0.0F);

// Samples of 0 to 3 are not ranges: corrected like an infinitely distant target.
template <class Form>
constexpr bool is_far_without_range(const Form& form) {
  return near(static_cast<double>(form(0)), -7.9905963, 1e-5) && form(1) == form(0) &&
         form(2) == form(0) && form(3) == form(0) && form(4) > 87;
}
static_assert(is_far_without_range(exact_correction{}));
static_assert(is_far_without_range(compact_correction{}));

static_assert(near(arctangent_deg(1.0), 45.0, 1e-13));
static_assert(near(arctangent_deg(-1.0), -45.0, 1e-13));
static_assert(arctangent_deg(0.0) == 0.0);
static_assert(near(arctangent_deg(std::numeric_limits<double>::max()), 90.0, 1e-13));
static_assert(near(far_correction_deg, arctangent_deg(-21.8 / 155.3), 1e-13));

const table_correction& table() {
  static const auto made = std::make_unique<table_correction>();
  return *made;
}

template <class Form>
double worst_error(const Form& form) {
  double worst = 0.0;
  for (unsigned raw = 0; raw <= 65535; ++raw) {
    const auto sample = static_cast<std::uint16_t>(raw);
    worst = std::max(
        worst, std::fabs(static_cast<double>(form(sample)) - reference::correction_deg(sample)));
  }
  return worst;
}

TEST(Correction, TableGivesTheManualsFigures) { EXPECT_TRUE(gives_the_figures(table(), 4e-6)); }

TEST(Correction, ExactFormIsTheFormulaInDoublePrecision) {
  EXPECT_LT(worst_error(exact_correction{}), 1e-13);
}

TEST(Correction, TableIsWithinItsBoundForEverySample) {
  EXPECT_LT(worst_error(table()), 4e-6);
  EXPECT_TRUE(is_far_without_range(table()));
}

TEST(Correction, CompactFormIsWithinItsBoundForEverySample) {
  EXPECT_LT(worst_error(compact_correction{}), 2e-5);
}

TEST(Correction, TheAngleOfTheHeadIsFoundAgainForEachKind) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  for (const float range_mm : {120.0F, 500.0F, 7999.0F}) {
    const double d = static_cast<double>(range_mm);
    const double triangle = std::atan(21.8 * (155.3 - d) / (155.3 * d)) * degrees;
    const double scl = std::atan(17.8 / d) * degrees;
    const auto head_of = [&](double correction, correction_kind kind) {
      point p;
      p.angle_deg = static_cast<float>(90.0 + correction);
      p.range_mm = range_mm;
      return static_cast<double>(raw_angle_deg(p, kind));
    };
    EXPECT_NEAR(head_of(triangle, correction_kind::triangle), 90.0, 1e-4);
    EXPECT_NEAR(head_of(scl, correction_kind::scl), 90.0, 1e-4);
    EXPECT_EQ(head_of(0.0, correction_kind::none), 90.0);
  }
}

TEST(Correction, FarTargets_ApproachTheStatedLimit) {
  EXPECT_NEAR(far_correction_deg, -7.9906, 0.00005);
  EXPECT_GT(exact_correction{}(65535), far_correction_deg);
  EXPECT_NEAR(std::atan(-21.8 / 155.3) * 180.0 / std::numbers::pi, far_correction_deg, 1e-14);
}

TEST(Correction, ArctangentIsWithinItsBoundFarAndNear) {
  // If long double is no wider than double, the reference itself has this error.
  constexpr bool wide = std::numeric_limits<long double>::digits > 60;
  constexpr double bound = wide ? 3e-14 : 6e-14;
  double worst = 0.0;
  const auto look_at = [&](double x) {
    const long double truth =
        std::atan(static_cast<long double>(x)) * 180.0L / std::numbers::pi_v<long double>;
    worst = std::max(
        worst, static_cast<double>(std::fabs(static_cast<long double>(arctangent_deg(x)) - truth)));
  };
  for (int step = -40000; step <= 40000; ++step) look_at(step / 10000.0);
  for (double x = 1e-300; x < 1e300; x *= 1.37) {
    look_at(x);
    look_at(-x);
  }
  // Both sides of every value at which the computation changes.
  for (int sixteenth = 1; sixteenth <= 16; ++sixteenth) {
    const double edge = sixteenth / 16.0;
    for (const double x : {std::nextafter(edge, 0.0), edge, std::nextafter(edge, 2.0)}) {
      look_at(x);
      look_at(1.0 / x);
    }
  }
  EXPECT_LT(worst, bound);
}

}  // namespace
}  // namespace g4lidar
