// SPDX-License-Identifier: MIT
// The core up to the points of a packet, with extreme numbers.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "core/sample_clock.hpp"
#include "g4lidar/core/angle.hpp"
#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/layout_recogniser.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/model_choice.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/filter/plausibility.hpp"
#include "g4lidar/settings.hpp"
#include "numbers.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();

// Constant expressions have no undefined arithmetic.
static_assert(wrap_deg(infinity) == 0.0F && wrap_deg(-infinity) == 0.0F && wrap_deg(1e30F) == 0.0F);
static_assert(angle::from_degrees(nan).degrees() == 0.0F);
static_assert(compact_correction{}(0, std::numeric_limits<std::int32_t>::max()) ==
              compact_correction{}(0));
static_assert(scl_correction{}(std::numeric_limits<std::int32_t>::max()) < 1e-3F);
static_assert(sample_clock(0).now_ns() == 0);
static_assert(scan_frequency::hz(1e300).chz == 65535);

// Not a constant expression for g++: the product is infinite.
TEST(Extreme, RadiansBeyondFloat) {
  EXPECT_EQ(angle::from_radians(std::numeric_limits<float>::max()).degrees(), 0.0F);
}

TEST(ExtremeCore, Angles) {
  with_extremes<float>([](float x) {
    const float wrapped = wrap_deg(x);
    EXPECT_TRUE(wrapped >= 0.0F && wrapped < 360.0F) << x << " gives " << wrapped;
    const angle a = angle::from_degrees(x);
    EXPECT_TRUE(a.degrees() >= 0.0F && a.degrees() < 360.0F) << x;
    use(angle::from_radians(x).radians());
    use(a.signed_degrees());
    use(a.forward_to(-a) + a.apart_from(a + a - a));
    use(wrap_once_deg(x));
    use(sine_cosine_deg(x));
    use(negative_mask(x));
  });
  with_extremes<double>([](double x) {
    const double wrapped = wrap_deg(x);
    EXPECT_TRUE(wrapped >= 0.0 && wrapped < 360.0) << x << " gives " << wrapped;
    use(wrap_once_deg(x));
    EXPECT_TRUE(std::isnan(x) == std::isnan(arctangent_deg(x))) << x;
  });
  with_extremes<std::uint32_t, float>([](std::uint32_t mask, float x) { use(masked(mask, x)); });
}

TEST(ExtremeCore, Corrections) {
  with_extremes<std::int32_t, std::int32_t>([](std::int32_t raw, std::int32_t least) {
    use(exact_correction{}(raw, least));
    use(compact_correction{}(raw, least));
    use(scl_correction{}(raw));
    use(no_correction{}(raw));
  });
  with_extremes<std::uint16_t>([](std::uint16_t raw) {
    static const auto table = std::make_unique<table_correction>();
    use((*table)(raw));
  });
  with_extremes<float>([](float x) { use(compact_correction::arctangent_ratio(x)); });
  with_extremes<correction_kind>([](correction_kind kind) { use(no_return_correction_deg(kind)); });
}

TEST(ExtremeCore, Samples) {
  with_extremes<std::uint16_t, std::uint16_t>([](std::uint16_t raw, std::uint16_t other) {
    use(flag_of(raw, other));
    use(flag_of<sample_layout::whole_mm>(raw, other));
    use(range_mm_of(raw));
    use(range_mm_of<sample_layout::intensity_16>(raw));
    use(sample_flags_of<sample_layout::flagged_mm>(raw));
    use(intensity_of<sample_layout::intensity_10>(raw, other));
    use(range_word<sample_layout::half_mm>::quarters(raw));
    use(range_word<sample_layout::half_mm>::correction(compact_correction{}, raw));
  });
  with_extremes<sample_layout, std::size_t>([](sample_layout layout, std::size_t count) {
    use(packet_size(count, layout));
    use(sample_size(layout));
    use(intensity_bits(layout));
    use(has_sample_flags(layout));
    use(range_units_per_mm(layout));
    use(longest_range_mm(layout));
  });
}

// A model that no table has.
model any_model(test::dice& random) {
  model made = models[random.below(models.size())];
  made.samples = {any<sample_layout>(random), any<correction_kind>(random),
                  any<std::uint8_t>(random)};
  for (sample_rate_entry& each : made.rates.entries)
    each = {any<std::uint32_t>(random), any<std::uint16_t>(random)};
  made.rates.nominal_hz = any<std::uint32_t>(random);
  made.rates.is_settable = any<bool>(random);
  made.rates.least_seen_hz = any<std::uint32_t>(random);
  made.rates.most_seen_hz = any<std::uint32_t>(random);
  made.frequency = {any<std::uint16_t>(random),
                    any<std::uint16_t>(random),
                    any<std::int16_t>(random),
                    any<std::int16_t>(random),
                    {}};
  made.range = {any<std::uint16_t>(random), any<std::uint16_t>(random)};
  made.turn_deg = any<std::uint16_t>(random);
  made.zero_angle_divisor = any<std::uint8_t>(random);
  return made;
}

TEST(ExtremeCore, Models) {
  many_times([](test::dice& random) {
    const model which = any_model(random);
    const auto number = any<std::uint32_t>(random);
    const auto byte = any<std::uint8_t>(random);
    use(highest_rate_hz(which));
    use(rate_hz_of_code(which, byte));
    use(code_of_rate(which, number));
    use(expected_rate_of(which, number));
    use(is_seen_rate(which, any<double>(random)));
    use(other_product(byte));
    use(true_frequency_chz(which, any<std::int32_t>(random)));
    use(true_frequency_chz(which, any<double>(random)));
    use(largest_scan(which));
    use(shortest_range_mm(which, number));
    use(one_way_other_than(which, byte));
    use(model_with_id(byte, any<link_kind>(random)));
    use(may_send(which, any<std::size_t>(random), true));
    use(may_measure(which, any<std::uint32_t>(random)));
    use(with_firmware(g4_model, {byte, byte, byte, byte, {}}));
    const request wanted{any<request_kind>(random), any<std::uint16_t>(random)};
    use(has_request(which, wanted.what));
    use(is_possible(wanted, which));
  });
}

TEST(ExtremeCore, Settings) {
  with_extremes<double>([](double hz) { use(scan_frequency::hz(hz)); });
  with_extremes<std::uint16_t>([](std::uint16_t chz) {
    use(scan_frequency{chz}.hz());
    use(requests::set(scan_frequency{chz}));
  });
  with_extremes<std::int32_t>([](std::int32_t cdeg) {
    use(zero_angle{cdeg}.deg() + pitch_angle{cdeg}.deg());
    use(zero_angle{cdeg}.is_calibrated());
  });
  with_extremes<sample_rate>([](sample_rate rate) {
    use(to_hz(rate));
    use(model_named("g4")->has_number(static_cast<std::uint8_t>(to_hz(rate))));
    use(requests::set(rate));
  });
  with_extremes<frequency_step>([](frequency_step by) { use(requests::step(by)); });
  with_extremes<std::uint8_t>([](std::uint8_t value) {
    use(reply_byte<low_power>(value));
    use(reply_byte<sample_rate>(value));
    use(traits_of(static_cast<command>(value)));
    use(encode(static_cast<command>(value)));
    use(layout_of_length(value));
    use(next_crc(value, value));
    use(name_of(static_cast<skip_reason>(value)));
    use(name_of(static_cast<health_status>(value)));
  });
}

TEST(ExtremeCore, Clock) {
  with_extremes<std::uint32_t>([](std::uint32_t rate_hz) {
    sample_clock clock(rate_hz);
    clock.tick();
    clock.tick(1000);
    EXPECT_GE(clock.now_ns(), 0);
  });
}

// Bytes of every format that a caller can state: also packets that are larger than all of a model.
TEST(ExtremeCore, Formats) {
  std::array<point, max_samples> points{};
  many_times(
      [&](test::dice& random) {
        const sample_format format{any<sample_layout>(random), any<correction_kind>(random),
                                   any<std::uint8_t>(random), any<bool>(random),
                                   any<std::uint8_t>(random)};
        std::vector<std::uint8_t> data(packet_size(random.below(256), format.layout), 0x55);
        data[0] = 0xAA;
        data[1] = random.below(8) == 0 ? 0x66 : 0x55;
        data[3] = static_cast<std::uint8_t>((data.size() - packet_header_size) /
                                            sample_size(format.layout));
        data[4] = data[6] = static_cast<std::uint8_t>(random.byte() | 1U);
        data[5] = random.byte();
        data[7] = random.byte();
        if (data[1] == 0x55) store_u16(data, 8, packet_checksum(data, format.layout));
        use(check_packet(data, format));
        use(check_response(data, format.has_angle_replies, format.largest_byte_reply));
        use(check_time_packet(data));
        use(what_stands_at_front(data, format));
        if (const auto packet = packet_view::from(data, format)) {
          EXPECT_LE(packet->data().size(), max_packet_size);
          std::array<std::uint16_t, max_samples> samples{};
          packet->copy_samples(samples);
          use(without_points(*packet, any<std::uint32_t>(random)));
          use(packet->span_64ths());
          angle_check angles;
          for (int i = 0; i < 3; ++i) use(angles.fits(*packet));
          angles.lost();
          if (packet->layout() == g4_layout)
            use(decode(*packet, compact_correction{}, any<std::uint32_t>(random), points,
                       any<std::uint16_t>(random)));
        }
        stream_parser parser(format);
        layout_recogniser recogniser;
        stream_counter counted;
        for (std::size_t at = 0; at < data.size();) {
          const std::size_t count = std::min(data.size() - at, 1 + random.below(200));
          const bytes piece = bytes(data).subspan(at, count);
          parser.feed(piece, [&](const event& found) { counted.add(found); });
          recogniser.take(piece);
          at += count;
        }
        EXPECT_LE(parser.held(), max_packet_size);
        while (const auto found = parser.finish()) counted.add(*found);
        recogniser.finish();
        EXPECT_LE(recogniser.votes(any<std::size_t>(random)), data.size());
        EXPECT_EQ(counted.parsed_bytes + counted.skipped_bytes(), data.size());
      },
      2000);
}

}  // namespace
