// SPDX-License-Identifier: MIT
// What is planted, and what shows it.
#include <algorithm>
#include <array>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "planted.hpp"

namespace g4_tool::acceptance::test {
namespace {

using enum step;

// ---- what is planted ----

/// The lidar is one of another model.
auto is_really(std::string_view word) {
  return [word](bench& of) { of.options = bench(word).options; };
}
auto returns_as(std::string_view word) {
  return [word](bench& of) {
    of.returns_as = bench(word).options;
    of.returns_as->info.serial_digits[0] = '3';
  };
}
/// It has other options.
auto with(void (*set)(sim::device_options&)) {
  return [set](bench& of) { set(of.options); };
}
/// It does not have this command, or has it.
auto without(std::initializer_list<std::uint8_t> codes) {
  return [gone = std::vector(codes)](bench& of) {
    sim::command_set fewer{};
    for (unsigned each = 0; each < 256; ++each) {
      const auto one = static_cast<std::uint8_t>(each);
      if (std::ranges::find(gone, one) == gone.end() && of.options.commands.has(one))
        fewer.add(one);
    }
    of.options.commands = fewer;
  };
}
auto having(std::uint8_t code) {
  return [code](bench& of) { of.options.commands.add(code); };
}
auto answers(std::uint8_t code, std::vector<std::uint8_t> reply) {
  return [=](bench& of) { of.replies[code] = reply; };
}
/// All rates have another ratio to those of the table.
auto rate_times(double ratio) {
  return [ratio](bench& of) { of.options.scanner.sample_rate_ratio = ratio; };
}
auto rates(std::array<std::uint32_t, 3> hz, std::uint16_t now) {
  return [=](bench& of) {
    of.options.scanner.format.rates_hz = hz;
    of.options.scanner.sample_rate = g4lidar::sample_rate{now};
  };
}
auto samples(std::uint8_t units_per_mm, sim::lower_bits lower) {
  return [=](bench& of) {
    of.options.scanner.format.code.units_per_mm = units_per_mm;
    of.options.scanner.format.code.lower = lower;
  };
}
/// A TG15 or R2 with this firmware, which is otherwise as before.
auto firmware(std::uint8_t minor) {
  return [minor](bench& of) {
    of.options.info.firmware_major = 1;
    of.options.info.firmware_minor = minor;
    of.options.zero_angle_cdeg = 3000;
  };
}
/// An old one, with something of a new one.
auto old_but(std::uint8_t minor, void (*set)(sim::device_options&)) {
  return [=](bench& of) {
    firmware(minor)(of);
    EXPECT_TRUE(sim::use_model(of.options, of.expected));
    set(of.options);
  };
}
auto sees_a_post_at(double m, double nearest_mm) {
  return [=](bench& of) {
    of.post_m = m;
    of.options.scanner.min_range_mm = nearest_mm;
  };
}

const std::vector<planted> differences{
    // The fields of the record, in its order.
    {"ids[0]", "t-mini-pro", with([](auto& of) { of.info.model = 9; }), identity,
     "number is 9, expected 150"},
    {"ids[0]", "x4-pro", with([](auto& of) { of.info.model = 3; }), ct_information,
     "number is 3, expected 4"},
    {"ids[1]", "s4b", with([](auto& of) { of.info.model = 12; }), identity,
     "number is 12, expected 11"},
    {"ids[1]", "x4-pro", with([](auto& of) { of.info.model = 7; }), ct_information,
     "number is 7, expected 6"},
    {"bauds[0]", "g4", with([](auto& of) { of.baud = 115'200; }), identity,
     "found_baud is 115200, expected"},
    {"bauds[0]", "x2", with([](auto& of) { of.baud = 153'600; }), listening,
     "found_baud is 153600, expected"},
    {"bauds[1]", "s2", with([](auto& of) { of.baud = 153'600; }), listening,
     "found_baud is 153600, expected"},
    {"samples.layout", "g2",
     [](bench& of) { of.options.scanner.format.code = bench("g2a").options.scanner.format.code; },
     stream, "sample_bytes is 2, expected 3"},
    {"samples.layout", "x4", samples(4, sim::lower_bits::range), sample_bits,
     "lower_bits is range, expected flags"},
    {"samples.layout", "t-mini-pro", samples(1, sim::lower_bits::intensity), sample_bits,
     "is intensity, expected"},
    {"samples.layout", "g2", samples(1, sim::lower_bits::flags), sample_bits,
     "is flags, expected intensity"},
    {"samples.layout", "tg30", with([](auto& of) { of.scanner.format.code.units_per_mm = 2; }),
     near_target, "measured_mm is 1600"},
    {"samples.layout", "tx8", with([](auto& of) { of.scanner.format.code.units_per_mm = 4; }),
     far_target, "measured_mm is 3200"},
    {"samples.correction", "g4",
     with([](auto& of) { of.scanner.format.beam = sim::straight_beam; }), near_target,
     "robot_bearing_deg is"},
    {"samples.correction", "t-mini",
     with([](auto& of) { of.scanner.format.beam = sim::triangle_beam; }), near_target,
     "robot_bearing_deg is"},
    {"samples.correction", "scl",
     with([](auto& of) { of.scanner.format.beam = sim::triangle_beam; }), near_target,
     "robot_bearing_deg is"},
    {"samples.max_samples", "x4", with([](auto& of) {
       of.scanner.format.max_samples = 80;
       of.scanner.samples_per_packet = 64;
     }),
     stream, "sample"},
    {"samples.has_angle_replies", "g6",
     answers(0x93, {0xA5, 0x5A, 4, 0, 0, 0, 4, 0x20, 0x4E, 1, 0}), queries,
     "zero_angle_93 is answered, although"},
    {"samples.largest_byte_reply", "g4", answers(0xD1, {0xA5, 0x5A, 1, 0, 0, 0, 4, 4}), queries,
     "rate_code is 4, expected"},
    {"link", "x2", is_really("s4"), listening, "sends_unasked is no, expected yes"},
    {"link", "x2", is_really("s4"), identity, "answers_90 is yes, expected no"},
    {"link", "x4", is_really("x4-pro"), identity, "answers_90 is no, expected yes"},
    {"link", "x4-pro",
     [](bench& of) {
       of.options = bench("x4").options;
       of.options.dtr_starts_by = sim::dtr_start::level;
       of.scans = true;
     },
     listening, "sends_after_65 is no, expected yes"},
    {"motor", "x4", with([](auto& of) { of.driven_by = sim::drive::commands; }), dtr,
     "low_silences is no, expected yes"},
    {"motor", "x2", with([](auto& of) { of.driven_by = sim::drive::power; }), dtr,
     "low_silences is no, expected yes"},
    {"motor", "x4-pro", with([](auto& of) {
       of.driven_by = sim::drive::dtr_line;
       of.dtr_starts_by = sim::dtr_start::level;
     }),
     dtr, "low_silences is yes, expected no"},
    {"rates.entries[0].hz", "g6", rates({10'000, 16'000, 18'000}, 18'000), sample_rate,
     "code_0_hz is 10"},
    {"rates.entries[1].hz", "g4", rates({4'000, 7'500, 9'000}, 9'000), sample_rate,
     "code_1_hz is 7"},
    {"rates.entries[2].hz", "g4", rates({4'000, 8'000, 9'540}, 4'000), sample_rate,
     "code_2_hz is 95"},
    {"rates.entries[2].hz", "g4", rate_times(1.06), stream, "sample_rate_hz is 95"},
    {"rates.entries[2].hz", "g4", rate_times(0.94), stream, "sample_rate_hz is 84"},
    {"rates.entries[0].hz", "x3-pro", rates({3'500, 4'500, 0}, 3'500), stream,
     "sample_rate_hz is 35"},
    {"rates.entries[0].shortest_mm", "g4",
     [](bench& of) {
       rates({4'000, 8'000, 9'000}, 4'000)(of);
       sees_a_post_at(0.07, 60.0)(of);
     },
     stream, "shortest_mm is 70"},
    {"rates.entries[1].shortest_mm", "g4",
     [](bench& of) {
       rates({4'000, 8'000, 9'000}, 8'000)(of);
       sees_a_post_at(0.2, 100.0)(of);
     },
     stream, "shortest_mm is 200"},
    {"rates.entries[2].shortest_mm", "g4", sees_a_post_at(0.2, 100.0), stream,
     "shortest_mm is 200"},
    {"rates.nominal_hz", "x2", rates({4'000, 0, 0}, 4'000), stream, "sample_rate_hz is 40"},
    {"rates.least_seen_hz", "x2", rates({2'300, 0, 0}, 2'300), stream, "sample_rate_hz is 2"},
    {"rates.most_seen_hz", "x2", rates({3'800, 0, 0}, 3'800), stream, "sample_rate_hz is 3"},
    {"rates.is_settable", "f4-pro", without({0xD0}), sample_rate, "answers_d0 is no, expected yes"},
    {"rates.is_settable", "f4-pro", rates({4'000, 0, 0}, 4'000), sample_rate,
     "codes is 1, expected 2"},
    {"rates.further_codes_hz[0]", "tg15",
     [](bench& of) {
       of.options.answers_sample_rate = of.options.other_rate_codes = true;
       of.options.scanner.format.other_rate_codes = {3, 1, 4};
       rates({10'000, 18'000, 20'000}, 10'000)(of);
     },
     stream, "sample_rate_hz is 10"},
    {"rates.further_codes_hz[1]", "tg15",
     [](bench& of) {
       of.options.answers_sample_rate = of.options.other_rate_codes = true;
       of.options.scanner.format.other_rate_codes = {3, 1, 4};
     },
     stream, "sample_rate_hz is 19999"},
    {"frequency.min_chz", "t-mini",
     with([](auto& of) { of.scanner.format.min_frequency_chz = 500; }), step::frequency,
     "lowest_hz is 5"},
    {"frequency.min_chz", "g4", with([](auto& of) { of.scanner.format.min_frequency_chz = 480; }),
     step::frequency, "lowest_hz is 4.8"},
    {"frequency.max_chz", "t-mini-pro", with([](auto& of) {
       of.scanner.scan_frequency_chz = 800;
       of.highest_frequency_chz = 900;
     }),
     step::frequency, "highest_hz is 9"},
    {"frequency.max_chz", "x4", having(0x0D), queries, "frequency_0d is answered, although"},
    {"frequency.max_chz", "g5", without({0x0D}), step::frequency,
     "is not answered, and was not changed"},
    {"frequency.reply_offset_chz", "tg30", with([](auto& of) { of.frequency_error_chz = 0; }),
     stream, "frequency_hz is"},
    {"frequency.reply_offset_chz", "g4", with([](auto& of) { of.frequency_error_chz = 40; }),
     stream, "frequency_hz is"},
    {"frequency.ct_offset_chz", "tg30", with([](auto& of) { of.scanner.format.ct_offset_chz = 0; }),
     stream, "offset_hz is"},
    {"range.min_mm", "x2", sees_a_post_at(0.08, 60.0), stream, "shortest_mm is 80"},
    {"range.min_mm", "t-mini", sees_a_post_at(0.03, 20.0), stream, "shortest_mm is 30"},
    {"range.max_mm", "x2",
     [](bench& of) {
       of.back_m = 10.0;
       of.options.scanner.max_range_mm = 12'000.0;
     },
     stream, "longest_mm is 10"},
    {"turn_deg", "t-mini-pro", with([](auto& of) { of.scanner.format.is_turned = true; }),
     near_target, "robot_bearing_deg is"},
    {"turn_deg", "x4", with([](auto& of) { of.scanner.format.is_turned = true; }), near_target,
     "robot_bearing_deg is"},
    {"turn_deg", "g2", with([](auto& of) { of.scanner.format.is_turned = false; }), near_target,
     "robot_bearing_deg is"},
    {"zero_angle_divisor", "tg30", without({0x93}), queries, "zero_angle_93 is not answered"},
    {"zero_angle_divisor", "tg30", with([](auto& of) {
       of.zero_angle_cdeg = 2500;
       of.zero_angle_divisor = 100;
     }),
     near_target, "robot_bearing_deg is"},
    {"protection", "tg30", without({0xD9}), step::protection, "answers_d9 is no, expected yes"},
    {"protection", "g6", without({0xD9}), step::protection, "answers_d9 is no, expected yes"},
    {"ct_information", "x4-pro", with([](auto& of) { of.ct_information = false; }), ct_information,
     "information is no, expected yes"},
    {"ct_information", "x4",
     with([](auto& of) { of.ct_information = of.ct_crc = of.stray_before_zero = true; }),
     ct_information, "information is yes, expected no"},
    {"ct_information", "s2", with([](auto& of) { of.ct_crc = false; }), ct_information,
     "crc_byte is no, expected yes"},
    {"has_motor_settings", "g4", without({0x05, 0x08}), queries,
     "motor_settings is no, expected yes"},
    {"has_motor_settings", "x4", having(0x08), queries, "motor_settings is yes, expected no"},
    {"other_layout", "s2",
     with([](auto& of) { of.scanner.format.code = {2, 1, sim::lower_bits::range}; }), stream,
     "sample_bytes is 4, expected"},
    {"other_layout", "x2",
     with([](auto& of) { of.scanner.format.code = {1, 1, sim::lower_bits::flags}; }), stream,
     "sample_bytes is 3, expected 2"},
    {"old_firmware.last_version", "tg15",
     [](bench& of) { old_but(2, [](auto& options) { options.info.firmware_minor = 3; })(of); },
     near_target, "measured_mm is 1600"},
    {"old_firmware.layout", "tg15",
     old_but(2, [](auto& of) { of.scanner.format.code.units_per_mm = 1; }), near_target,
     "measured_mm is 400"},
    {"old_firmware.ct_offset_chz", "tg15",
     old_but(2, [](auto& of) { of.scanner.format.ct_offset_chz = 300; }), stream, "offset_hz is"},
    {"old_firmware.zero_angle_divisor", "r2",
     old_but(7,
             [](auto& of) {
               of.zero_angle_cdeg = 2500;
               of.zero_angle_divisor = 100;
             }),
     near_target, "robot_bearing_deg is"},
    {"has_pitch", "t-mini-plus-sh", without({0x98}), queries, "pitch_98 is not answered"},
    // What the table does not have.
    {"", "g4", answers(0x90, {0xA5, 0x5A, 19, 0, 0, 0, 4, 5, 1, 2, 3, 2, 0,
                              2,    1,    1,  0, 1, 0, 0, 0, 0, 7, 0, 0, 7}),
     identity, "reply_bytes is 19, expected 20"},
    {"", "g4", answers(0x91, {0xA5, 0x5A, 4, 0, 0, 0, 6, 0, 0, 0, 0}), queries,
     "health_91 has 4 bytes, expected 3"},
    {"", "g4", answers(0x92, {0xA5, 0x5A, 3, 0, 0, 0, 6, 0, 0}), queries,
     "health_92 has 2 bytes, expected 3"},
    {"", "tg30", answers(0x93, {0xA5, 0x5A, 2, 0, 0, 0, 4, 0, 0}), queries,
     "zero_angle_93 has 2 bytes, expected 4"},
    {"", "t-mini-plus-sh", answers(0x98, {0xA5, 0x5A, 5, 0, 0, 0, 0x10, 0, 0, 0, 0, 0}), queries,
     "pitch_98 has 5 bytes, expected 4"},
    {"", "g4", with([](auto& of) { of.answers_health_91 = of.answers_health_92 = false; }), queries,
     "health is no, expected yes"},
    {"", "tg15", with([](auto& of) { of.ct_crc = false; }), ct_information,
     "A byte follows that is not the CRC."},
    {"", "tg15", with([](auto& of) { of.ct_crc = false; }), ct_information,
     "crc_byte is no, expected yes"},
    {"", "tg30", [](bench& of) { of.set_baud = 500'000; }, bridge, "set_baud is 500000, expected"},
    {"", "x4", with([](auto& of) { of.motor_has_power = false; }), start_and_stop,
     "second one give power"},
    {"", "t-mini-pro", without({0x65}), start_and_stop, "stops_by_65 is no, expected yes"},
    {"", "x2", [](bench& of) { of.stays_unplugged = true; }, unplug,
     "came_back is no, expected yes"},
    {"", "x2", returns_as("s4"), unplug, "sends_again is no, expected yes"},
    {"", "x4", returns_as("x4"), unplug, "same_lidar is no, expected yes"},
    {"", "tg30", returns_as("tg30"), unplug, "same_lidar is no, expected yes"},
};

}  // namespace

std::span<const planted> all_planted() { return differences; }

}  // namespace g4_tool::acceptance::test
