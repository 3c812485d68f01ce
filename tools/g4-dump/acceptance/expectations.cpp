// SPDX-License-Identifier: MIT
// What is expected of each fact, with the tolerance of the model.
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "g4lidar/core/model_record.hpp"
#include "kit_rows.hpp"

namespace g4_tool::acceptance {
namespace {

constexpr expected unknown{.is_known = false};
constexpr expected yes{1.0, 1.0};
constexpr expected no{0.0, 0.0};

expected as(bool is_so) noexcept { return is_so ? yes : no; }
expected as(presence stated) noexcept {
  return stated == presence::unknown ? unknown : as(stated == presence::yes);
}
expected around(double value, double tolerance) noexcept {
  return {value - tolerance, value + tolerance};
}

/// Around the one of `values` that is nearest to `seen`, by a fraction of it; 0 is none of them.
expected nearest(std::initializer_list<double> values, double seen,
                 double tolerance = 0.0) noexcept {
  double best = 0.0;
  for (const double each : values) {
    const bool is_nearer = best == 0.0 || std::abs(each - seen) < std::abs(best - seen);
    if (each != 0.0 && is_nearer) best = each;
  }
  return around(best, best * tolerance);
}

expected must(const known_facts& /*facts*/) noexcept { return yes; }

/// The time between two samples is within the tolerance.
expected rate_within(double hz, double tolerance) noexcept {
  return {hz / (1.0 + tolerance), hz / (1.0 - tolerance)};
}

/// What an answer states is true within this; see expected_rate_of().
constexpr double answered_tolerance = 0.04;

template <std::size_t Code>
expected rate_of_code(const known_facts& facts) noexcept {
  const std::uint32_t hz = rate_hz_of_code(facts.row, Code);
  return rate_within(hz, expected_rate_of(facts.row, hz).tolerance);
}

/// By the answer of the lidar, by the model, or the nearest of several.
expected_rate rate_of_stream(const known_facts& facts) noexcept {
  const double code = facts.number("rate_code", all_rate_codes);
  const std::uint32_t answered =
      code >= 0.0 ? rate_hz_of_code(facts.row, static_cast<std::uint8_t>(code)) : 0;
  if (answered != 0) return {1.0 * answered, answered_tolerance};
  const sample_rate_list& rates = facts.row.rates;
  if (!rates.is_settable && rates.nominal_hz != 0)
    return expected_rate_of(facts.row, rates.nominal_hz);
  const double seen = facts.number("sample_rate_hz");
  const auto& [first, second, third] = rates.entries;
  const expected near = nearest({1.0 * first.hz, 1.0 * second.hz, 1.0 * third.hz}, seen);
  return {near.least, rates.is_settable ? answered_tolerance : 0.1};
}

expected turning(const known_facts& facts) noexcept {
  const double answered_hz = facts.number("answered_hz");
  if (answered_hz <= 0.0 || facts.row.frequency.max_chz == 0) return unknown;
  const double hz = answered_hz + facts.row.frequency.reply_offset_chz / 100.0;
  return around(hz, std::max(0.25, 0.03 * hz));
}

expected has_code(const known_facts& facts) noexcept {
  const double seen = facts.number("rate_code");
  if (seen > facts.row.samples.largest_byte_reply)
    return {0.0, 1.0 * facts.row.samples.largest_byte_reply};
  const bool means_a_rate = rate_hz_of_code(facts.row, static_cast<std::uint8_t>(seen)) != 0;
  return means_a_rate ? around(seen, 0.0) : expected{0.0, rate_count(facts.row) - 1.0};
}

/// Sent by the models whose CT bytes have information, and seen at a TG15.
expected has_crc(const known_facts& facts) noexcept {
  const bool is_tg = facts.is_two_way && facts.row.rates.further_codes_hz[0] != 0;
  return is_tg ? yes : as(facts.row.ct_information);
}

expected placed(const known_facts& facts) noexcept {
  const double mm = facts.number("placed_mm");
  return around(mm, std::max(30.0, 0.05 * mm));
}

expected longest_packet(const known_facts& facts) noexcept {
  return {.most = 1.0 * facts.row.samples.max_samples};
}

expected one_way(const known_facts& facts) noexcept { return facts.is_two_way ? unknown : yes; }

/// A G may have commands that nobody has tried with it.
expected unknown_of_g(const known_facts& facts) noexcept {
  return facts.is_two_way && facts.row.motor == motor_kind::command ? unknown : no;
}
expected by_number(const known_facts& facts) noexcept {
  return nearest({1.0 * facts.row.ids[0], 1.0 * facts.row.ids[1]}, facts.number("number"));
}
expected by_low_bits(const known_facts& facts) noexcept {
  return nearest({1.0 * (facts.row.ids[0] & 15U), 1.0 * (facts.row.ids[1] & 15U)},
                 facts.number("number"));
}

constexpr double baud_tolerance = 0.015;

expected by_bauds(const known_facts& facts) noexcept {
  return nearest({1.0 * facts.row.bauds[0], 1.0 * facts.row.bauds[1]}, facts.number("found_baud"),
                 baud_tolerance);
}

constexpr std::array checks{
    check_row{step::bridge, "set_baud",
              [](const known_facts& facts) {
                return nearest({facts.number("wanted_baud")}, 0.0, baud_tolerance);
              }},
    check_row{step::listening, "sends_unasked", one_way},
    check_row{step::listening, "sends_after_65", one_way},
    check_row{step::listening, "found_baud", by_bauds},
    check_row{step::identity, "found_baud", by_bauds},
    check_row{step::identity, "answers_90",
              [](const known_facts& facts) { return as(facts.is_two_way); }},
    check_row{step::identity, "reply_bytes", [](const known_facts&) { return around(20.0, 0.0); }},
    check_row{step::identity, "number", by_number},
    check_row{step::queries, "health",
              [](const known_facts& facts) { return as(facts.is_two_way); }},
    check_row{step::queries, "rate_code", has_code},
    check_row{step::queries, "motor_settings",
              [](const known_facts& facts) {
                return facts.row.has_motor_settings ? yes : unknown_of_g(facts);
              }},
    check_row{step::protection, "answers_d9",
              [](const known_facts& facts) { return as(facts.row.protection); }},
    check_row{
        step::frequency, "lowest_hz",
        [](const known_facts& facts) { return around(facts.row.frequency.min_chz / 100.0, 0.06); }},
    check_row{
        step::frequency, "highest_hz",
        [](const known_facts& facts) { return around(facts.row.frequency.max_chz / 100.0, 0.06); }},
    check_row{step::sample_rate, "answers_d0", must},
    check_row{step::sample_rate, "codes",
              [](const known_facts& facts) { return around(rate_count(facts.row), 0.0); }},
    check_row{step::sample_rate, "code_0_hz", rate_of_code<0>},
    check_row{step::sample_rate, "code_1_hz", rate_of_code<1>},
    check_row{step::sample_rate, "code_2_hz", rate_of_code<2>},
    check_row{step::sample_rate, "most_samples", longest_packet},
    check_row{step::start_and_stop, "starts", must, false,
              "Where two plugs are needed, does the second one give power to the motor?"},
    check_row{step::start_and_stop, "turns_steadily", must},
    check_row{step::start_and_stop, "stops_by_65", must},
    check_row{step::dtr, "starts_with_edge", must},
    check_row{step::dtr, "low_silences",
              [](const known_facts& facts) { return as(facts.row.motor == motor_kind::dtr); }},
    check_row{step::stream, "packets", [](const known_facts&) { return expected{1.0}; }},
    check_row{step::stream, "sample_bytes",
              [](const known_facts& facts) {
                return nearest({static_cast<double>(sample_size(facts.row.samples.layout)),
                                static_cast<double>(sample_size(facts.row.other_layout))},
                               facts.number("sample_bytes"));
              }},
    check_row{step::stream, "damaged_percent",
              [](const known_facts&) { return expected{.most = 1.0}; }},
    check_row{step::stream, "most_samples", longest_packet},
    check_row{step::stream, "sample_rate_hz",
              [](const known_facts& facts) {
                const auto [hz, tolerance] = rate_of_stream(facts);
                return rate_within(hz, tolerance);
              }},
    check_row{step::stream, "frequency_hz", turning},
    check_row{step::stream, "offset_hz",
              [](const known_facts& facts) {
                return around(facts.row.frequency.ct_offset_chz / 100.0, 0.25);
              }},
    check_row{step::stream, "shortest_mm",
              [](const known_facts& facts) {
                const auto hz = static_cast<std::uint32_t>(rate_of_stream(facts).hz);
                return expected{.least = 0.95 * shortest_range_mm(facts.row, hz)};
              },
              true},
    check_row{
        step::stream, "longest_mm",
        [](const known_facts& facts) { return expected{.most = 1.05 * facts.row.range.max_mm}; },
        true},
    check_row{step::ct_information, "crc_byte", has_crc},
    check_row{step::ct_information, "information",
              [](const known_facts& facts) { return as(facts.row.ct_information); }},
    check_row{step::ct_information, "number", by_low_bits},
    check_row{step::near_target, "starts", must},
    check_row{step::near_target, "measured_mm", placed},
    check_row{step::near_target, "robot_bearing_deg",
              [](const known_facts&) { return around(0.0, 5.0); }},
    check_row{step::far_target, "starts", must},
    check_row{step::far_target, "measured_mm", placed},
    check_row{step::unplug, "connection_lost", must},
    check_row{step::unplug, "came_back", must},
    check_row{step::unplug, "same_lidar", must},
    check_row{step::unplug, "sends_again", one_way},
};

}  // namespace

std::span<const check_row> check_rows() noexcept { return checks; }

}  // namespace g4_tool::acceptance
