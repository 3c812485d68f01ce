// SPDX-License-Identifier: MIT
// The table of the models of lidars, and the search in it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "g4lidar/core/label.hpp"
#include "g4lidar/core/model_record.hpp"
#include "g4lidar/settings.hpp"

namespace g4lidar {

/// The model that is used where none is named. An object of its own: a program that uses no other
/// model does not contain the table.
inline constexpr model g4_model{
    .word = "g4",
    .name = "G4",
    .ids = {5},
    .bauds = {230400},
    .samples = {sample_layout::quarter_mm, correction_kind::triangle, 80},
    .link = link_kind::two_way,
    .motor = motor_kind::command,
    .rates = {{{{4000, 100}, {8000, 260}, {9000, 280}}}, 9000, true},
    .frequency = {50, 120},
    .range = {100, 16000},
    .turn_deg = 180,
    .zero_angle_divisor = 0,
    .protection = presence::yes,
    .ct_information = presence::unknown,
    .has_motor_settings = true,
    .usual = usual_kind::of_its_layout,
};
/// How its samples are read.
inline constexpr sample_format g4_format = g4_model.samples;
/// How its samples are laid out.
inline constexpr sample_layout g4_layout = g4_format.layout;

/// All models, the G4 first. Valid forever. What is not known of a model has the value that claims
/// least: presence::unknown, a nominal rate of 0.
inline constexpr auto models = [] {
  using enum sample_layout;
  using enum correction_kind;
  using enum link_kind;
  using enum motor_kind;
  using enum presence;
  constexpr auto at_its_rate = usual_kind::at_its_rate;
  constexpr auto of_its_layout = usual_kind::of_its_layout;
  constexpr sample_format quarter_samples{quarter_mm, triangle};
  constexpr sample_format flagged_samples{flagged_mm, triangle};
  constexpr sample_format half_mm_samples{half_mm, triangle};
  constexpr sample_format zeroed_samples{quarter_mm, triangle, 40, true};
  constexpr sample_format zeroed_10{intensity_10, triangle, 40, true};
  constexpr sample_format triangle_10{intensity_10, triangle};
  constexpr sample_format triangle_8{intensity_8, triangle};
  constexpr sample_format scl_samples{intensity_8, scl};
  constexpr sample_format tof_8{intensity_8, correction_kind::none};
  constexpr sample_format tof_16{intensity_16, correction_kind::none, 40, true};
  constexpr sample_format tof_mm{whole_mm, correction_kind::none};
  constexpr sample_format tg_samples{whole_mm, correction_kind::none, 40, true, all_rate_codes - 1};

  constexpr auto fixed = [](std::uint32_t hz, std::uint16_t shortest_mm = 0) {
    return sample_rate_list{{{{hz, shortest_mm}}}, hz, false};
  };
  constexpr sample_rate_list f4_rates{{{{4000}, {6000}}}, 4000, true};
  constexpr sample_rate_list g6_rates{{{{8000, 100}, {16000, 260}, {18000, 280}}}, 18000, true};
  constexpr sample_rate_list x2_rates{{{{3000}}}, 3000, false, {}, 2500, 3600};
  constexpr sample_rate_list x3_pro_rates{{{{3000}, {4000}}}};
  constexpr sample_rate_list s2_rates{{{{3000}, {4000}, {5000}}}};
  constexpr sample_rate_list tg_rates{{{{10000}, {18000}, {20000}}}, 0, false, {20000, 10000}};

  constexpr auto by_pin = [](std::string_view pin) { return frequency_properties{.pin = pin}; };
  constexpr frequency_properties by_sctr = by_pin("M_SCTR");
  constexpr frequency_properties by_ctr = by_pin("M_CTR");
  constexpr frequency_properties by_either = by_pin("M_CTR or M_SCTP");
  constexpr frequency_properties by_any = by_pin("M_SCTR or M_CTR");
  constexpr frequency_properties by_some = by_pin("for the speed");
  constexpr frequency_properties set_5_to_12{50, 120};
  constexpr frequency_properties set_6_to_12{60, 120};
  constexpr frequency_properties tg_frequency{30, 160, -40, 30};

  constexpr firmware_difference r2_old{0x0107, quarter_mm, 0, 4};
  constexpr firmware_difference tg_old{0x0102, half_mm, 0, 4};

  // One column a field; the formatter would write one field a line.
  // clang-format off
  // word, name, ids, bauds, samples, link, motor,
  // rates, frequency, range, turn, divisor of the zero angle, protection, information in CT,
  // motor settings, other layout, old firmware, pitch, whether it is the usual one
  return std::to_array<model>({
      g4_model,
      {"g4-pro",         "G4 Pro",         {7},     {230400},         g4_format,       two_way, command,
       g4_model.rates,   set_5_to_12,  {100, 16000}, 180, 0,   yes,     unknown, true},
      {"g5",             "G5",             {20},    {230400},         g4_format,       two_way, command,
       g4_model.rates,   set_5_to_12,  {100, 16000}, 180, 0,   unknown, unknown},
      {"f4",             "F4",             {1},     {115200},         quarter_samples, two_way, command,
       fixed(4000),      set_5_to_12,  {120, 12000}, 180, 0,   no,      unknown},
      {"f4-pro",         "F4 Pro",         {8, 4},  {230400},         quarter_samples, two_way, command,
       f4_rates,         set_5_to_12,  {120, 12000}, 180, 0,   yes,     unknown, true},
      {"g1",             "G1",             {19},    {230400},         zeroed_samples , two_way, command,
       fixed(9000, 280), set_5_to_12,  {100, 16000}, 180, 4,   unknown, unknown},
      {"g2",             "G2",             {15},    {230400},         zeroed_10,       two_way, command,
       fixed(5000, 280), set_5_to_12,  {100, 16000}, 180, 4,   unknown, unknown},
      {"g2a",            "G2A",            {14},    {230400},         zeroed_samples , two_way, command,
       fixed(5000),      set_5_to_12,  {100, 12000}, 180, 4,   unknown, unknown},
      {"g2c",            "G2C",            {16},    {115200},         zeroed_samples , two_way, command,
       fixed(4000),      set_5_to_12,  {100, 12000}, 180, 4,   unknown, unknown},
      {"g4c",            "G4C",            {18},    {115200},         quarter_samples, two_way, command,
       fixed(4000),      set_5_to_12,  {100, 12000}, 180, 0,   unknown, unknown},
      {"g4b",            "G4B",            {17},    {512000},         triangle_10,     two_way, command,
       fixed(10000),     set_5_to_12,  {120, 16000}, 180, 0,   unknown, unknown},
      {"r2",             "R2",             {9},     {230400},         zeroed_samples , two_way, command,
       fixed(5000),      set_5_to_12,  {120, 16000}, 180, 100, unknown, unknown, false, quarter_mm, r2_old},
      {"g6",             "G6",             {13},    {512000},         half_mm_samples, two_way, command,
       g6_rates,         set_5_to_12,  {100, 25000}, 180, 0,   yes,     unknown},
      {"g7",             "G7",             {21},    {512000},         half_mm_samples, two_way, command,
       g6_rates,         set_5_to_12,  {100, 25000}, 180, 0,   yes,     unknown},
      {"x4",             "X4",             {6},     {128000},         flagged_samples, two_way, dtr,
       fixed(5000),      by_sctr,      {120, 10000}, 0,   0,   no,      no},
      {"x4-pro",         "X4 Pro",         {4, 6},  {128000},         flagged_samples, one_way, supply,
       fixed(5000),      by_ctr,       {120, 10000}, 0,   0,   no,      yes, false, flagged_mm, {}, false, at_its_rate},
      {"x2",             "X2",             {4, 6},  {115200},         flagged_samples, one_way, dtr,
       x2_rates,         by_either,    {100, 8000},  0,   0,   no,      unknown, false, flagged_mm, {}, false, of_its_layout},
      {"x2l",            "X2L",            {4, 6},  {115200},         flagged_samples, one_way, dtr,
       x2_rates,         by_either,    {100, 8000},  0,   0,   no,      unknown},
      {"x3",             "X3",             {4, 6},  {115200},         flagged_samples, one_way, dtr,
       x2_rates,         by_any,       {100, 8000},  0,   0,   no,      unknown},
      {"x3-pro",         "X3 Pro",         {4, 6},  {115200},         flagged_samples, one_way, dtr,
       x3_pro_rates,     by_any,       {100, 8000},  0,   0,   no,      unknown, false, flagged_mm, {}, false, at_its_rate},
      {"s2",             "S2",             {4, 12}, {115200, 128000}, flagged_samples, one_way, dtr,
       s2_rates,         by_any,       {80, 12000},  0,   0,   no,      yes, false, intensity_8},
      {"s2-pro",         "S2 Pro",         {4, 12}, {115200, 128000}, flagged_samples, one_way, dtr,
       s2_rates,         by_any,       {80, 12000},  0,   0,   no,      yes, false, intensity_8, {}, false, at_its_rate},
      // Their bauds carry 3 kHz of such samples, not 4.
      {"s2-intensity",   "S2 with intensity", {4, 12}, {115200, 128000}, triangle_8,   one_way, dtr,
       fixed(3000),      by_any,       {80, 12000},  0,   0,   no,      yes, false, flagged_mm},
      {"s2-pro-intensity", "S2 Pro with intensity", {4, 12}, {115200, 128000}, triangle_8, one_way, dtr,
       fixed(3000),      by_any,       {80, 12000},  0,   0,   no,      yes, false, flagged_mm, {}, false, at_its_rate},
      {"s4",             "S4",             {4},     {115200},         flagged_samples, two_way, dtr,
       fixed(4000),      by_some,      {100, 8000},  0,   0,   no,      unknown},
      {"s4b",            "S4B",            {4, 11}, {153600},         triangle_8,      two_way, dtr,
       fixed(4000),      by_some,      {100, 8000},  0,   0,   no,      unknown},
      {"scl",            "SCL",            {22},    {115200},         scl_samples,     one_way, dtr,
       fixed(3000),      by_some,      {120, 8000},  0,   0,   no,      unknown},
      {"t-mini",         "T-mini",         {140},   {230400},         tof_8,           two_way, command,
       fixed(4000),      set_6_to_12,  {50, 12000},  0,   0,   unknown, unknown},
      {"t-mini-pro",     "T-mini Pro",     {150},   {230400},         tof_8,           two_way, command,
       fixed(4000),      set_6_to_12,  {20, 12000},  0,   0,   unknown, unknown, false, intensity_8, {}, false, of_its_layout},
      {"t-mini-plus",    "T-mini Plus",    {151},   {230400},         tof_8,           two_way, command,
       fixed(4000),      set_6_to_12,  {50, 12000},  0,   0,   unknown, unknown},
      {"t-mini-plus-sh", "T-mini Plus SH", {152},   {230400},         tof_16,          two_way, command,
       fixed(4000),      set_6_to_12,  {50, 25000},  0,   0,   unknown, unknown, false, intensity_16, {}, true, of_its_layout},
      {"tg15",           "TG15",           {100},   {512000},         tg_samples,      two_way, command,
       tg_rates,         tg_frequency, {50, 30000},  180, 4,   yes,     unknown, false, whole_mm, tg_old},
      {"tg30",           "TG30",           {101},   {512000},         tg_samples,      two_way, command,
       tg_rates,         tg_frequency, {50, 30000},  180, 4,   yes,     unknown, false, whole_mm, tg_old},
      {"tg50",           "TG50",           {102},   {512000},         tg_samples,      two_way, command,
       tg_rates,         tg_frequency, {50, 50000},  180, 4,   yes,     unknown, false, whole_mm, tg_old},
      {"tx8",            "TX8",            {100},   {115200},         tof_mm,          one_way, dtr,
       fixed(4000),      by_some,      {50, 8000},   0,   0,   no,      unknown},
      {"tx20",           "TX20",           {100},   {115200},         tof_mm,          one_way, dtr,
       fixed(4000),      by_some,      {50, 20000},  0,   0,   no,      unknown},
  });
  // clang-format on
}();

/// The model with this word or label, in any spelling, or null: "x4-pro", "YDLIDAR X4 Pro". See is_label_of(). Valid
/// forever. *Pure.*
[[nodiscard]] constexpr const model* model_named(std::string_view label) noexcept {
  for (const model& each : models) {
    if (is_label_of(label, each.word)) return &each;
  }
  return nullptr;
}

/// "an" before the names that are spoken with a vowel, as X4 and SCL; else "a". *Pure.*
[[nodiscard]] constexpr std::string_view article_of(const model& which) noexcept {
  return std::string_view("FRSX").find(which.name.front()) != std::string_view::npos ? "an" : "a";
}

/// The model whose devices, and no other model's with a connection of this kind, identify themselves
/// with `id`; else null. Valid forever. *Pure.* A reply comes from a two-way lidar; an announcement
/// after power-on may come from a one-way lidar.
[[nodiscard]] constexpr const model* model_with_id(std::uint8_t id, link_kind link) noexcept {
  if (id == 0) return nullptr;
  const model* found = nullptr;
  for (const model& each : models) {
    if (each.link != link || !each.has_number(id)) continue;
    if (found != nullptr) return nullptr;
    found = &each;
  }
  return found;
}

namespace detail {

/// Whether the rates of `row` are complete and in ascending order. *Pure.*
[[nodiscard]] constexpr bool has_consistent_rates(const model& row) noexcept {
  bool has_nominal = row.rates.nominal_hz == 0;
  std::uint32_t last = 0;
  bool ended = false;
  for (const sample_rate_entry& rate : row.rates.entries) {
    ended = ended || rate.hz == 0;
    if (ended) {
      if (rate.hz != 0 || rate.shortest_mm != 0) return false;
      continue;
    }
    if (rate.hz <= last) return false;
    if (rate.shortest_mm != 0 && rate.shortest_mm < row.range.min_mm) return false;
    last = rate.hz;
    has_nominal = has_nominal || rate.hz == row.rates.nominal_hz;
  }
  for (const std::uint32_t hz : row.rates.further_codes_hz) {
    const bool is_read = row.samples.largest_byte_reply == all_rate_codes - 1;
    if (hz != 0 && (!is_read || code_of_rate(row, hz) == rate_count(row))) return false;
  }
  return last != 0 && has_nominal;
}

/// Whether the longest packet of `row` in this layout fits into the memory for a packet. *Pure.*
[[nodiscard]] constexpr bool has_room_for(const model& row, sample_layout layout) noexcept {
  constexpr std::size_t room = std::size_t{2} * 80;
  return row.samples.max_samples * sample_size(layout) <= room;
}

/// Whether the fields of `row` agree with each other and with the protocol. *Pure.*
[[nodiscard]] constexpr bool is_consistent(const model& row) noexcept {
  const auto& [min_dhz, max_dhz, reply_offset, ct_offset, pin] = row.frequency;
  const bool has_limits = 0 < row.range.min_mm && row.range.min_mm < row.range.max_mm &&
                          (min_dhz < max_dhz || max_dhz == 0) && pin.empty() == (max_dhz != 0);
  const bool has_names = !row.word.empty() && !row.name.empty() && row.bauds[0] != 0 &&
                         row.ids[0] != 0 && row.ids[0] != row.ids[1];
  const bool has_memory = row.samples.max_samples > 0 && has_room_for(row, row.samples.layout) &&
                          has_room_for(row, row.other_layout);
  const firmware_difference& old = row.old_firmware;
  const bool is_parsed =
      old.last_version == 0 || (sample_size(old.layout) == sample_size(row.samples.layout) &&
                                (old.zero_angle_divisor != 0) == (row.zero_angle_divisor != 0));
  const bool takes_commands = row.motor == motor_kind::command || row.rates.is_settable ||
                              max_dhz != 0 || row.zero_angle_divisor != 0 || row.has_pitch ||
                              row.has_motor_settings || row.protection != presence::no;
  const bool has_angles = row.zero_angle_divisor != 0 || row.has_pitch;
  return has_names && has_limits && has_memory && is_parsed && has_consistent_rates(row) &&
         has_angles == row.samples.has_angle_replies &&
         (row.link == link_kind::two_way || !takes_commands) &&
         (row.turn_deg == 0 || row.turn_deg == 180);
}

/// Whether all rows are consistent, and no two have the same word. *Pure.*
[[nodiscard]] constexpr bool are_consistent() noexcept {
  for (const model& row : models) {
    if (!is_consistent(row) || model_named(row.word) != &row) return false;
  }
  return true;
}

}  // namespace detail

static_assert(detail::are_consistent());

namespace detail {

/// The models whose old firmware differs, with that firmware.
inline constexpr auto old_models = [] {
  constexpr auto has_other = [](const model& row) { return row.old_firmware.last_version != 0; };
  constexpr auto count = std::count_if(models.begin(), models.end(), has_other);
  std::array<model, count> found{};
  auto end = std::copy_if(models.begin(), models.end(), found.begin(), has_other);
  for (auto each = found.begin(); each != end; ++each) {
    const firmware_difference old = each->old_firmware;
    each->samples.layout = each->other_layout = old.layout;
    each->frequency.ct_offset_dhz = old.ct_offset_dhz;
    each->zero_angle_divisor = old.zero_angle_divisor;
    each->old_firmware = {};
  }
  return found;
}();

/// Whether a device of the model `row` may identify itself with `number`. CT bytes have only the lower
/// four bits of it. *Pure.*
[[nodiscard]] constexpr bool may_report(const model& row, std::uint8_t number) noexcept {
  constexpr std::uint8_t in_ct = 15;
  const auto is_it = [&](std::uint8_t id) {
    return id != 0 && (id == number || (number <= in_ct && (id & in_ct) == number));
  };
  return is_it(row.ids[0]) || is_it(row.ids[1]);
}

/// Whether the packets of a device of the model `row` can be valid where `which` is read. *Pure.*
[[nodiscard]] constexpr bool is_read_as(const model& row, const model& which) noexcept {
  const bool has_baud = std::any_of(row.bauds.begin(), row.bauds.end(), [&](std::uint32_t baud) {
    return baud != 0 && (baud == which.bauds[0] || baud == which.bauds[1]);
  });
  return has_baud && sample_size(row.samples.layout) == sample_size(which.samples.layout);
}

}  // namespace detail

/// The model `which` of the table, as a device of it is that has reported `who`: with old firmware another
/// record, of the same name. Valid forever; `which` itself if nothing differs. *Pure.*
// NOLINTBEGIN(bugprone-return-const-ref-from-parameter): models are those of the table
[[nodiscard]] constexpr const model& with_firmware(const model& which,
                                                   const device_information& who) noexcept {
  const unsigned version = who.firmware_major * 256U + who.firmware_minor;
  if (!which.has_number(who.model) || version > which.old_firmware.last_version) return which;
  for (const model& each : detail::old_models) {
    if (each == which) return each;
  }
  return which;
}
// NOLINTEND(bugprone-return-const-ref-from-parameter)

/// The model to which a one-way lidar that identifies itself with `number` belongs instead of `which`; null
/// if it may be `which`. Several models report 4 and 6, so these numbers contradict no one-way model. Valid
/// forever. *Pure.*
[[nodiscard]] constexpr const model* one_way_other_than(const model& which,
                                                        std::uint8_t number) noexcept {
  if (detail::may_report(which, number)) return nullptr;
  const model* found = nullptr;
  for (const model& each : models) {
    if (each.link != link_kind::one_way || !detail::may_report(each, number)) continue;
    if (found != nullptr && found->ids != each.ids) return nullptr;
    if (found == nullptr) found = &each;
  }
  if (found != nullptr) return found;
  for (const model& each : models) {
    if (detail::may_report(each, number) && detail::is_read_as(each, which)) return &each;
  }
  return nullptr;
}

}  // namespace g4lidar
