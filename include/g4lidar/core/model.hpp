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
    .frequency = {500, 1200},
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
  using enum link_kind;
  using enum motor_kind;
  using enum presence;
  constexpr auto fixed = [](std::uint32_t hz, std::uint16_t shortest_mm = 0) {
    return sample_rate_list{.entries = {{{hz, shortest_mm}}}, .nominal_hz = hz};
  };
  constexpr auto by_pin = [](std::string_view pin) { return frequency_properties{.pin = pin}; };
  // `base` with another word and name, changed by `differ`. If `base` has one layout only, so has the result.
  constexpr auto like = [](const model& base, std::string_view word, std::string_view name,
                           auto differ) {
    model made = base;
    made.word = word;
    made.name = name;
    differ(made);
    const bool has_one = base.other_layout == base.samples.layout;
    if (has_one && made.other_layout == base.other_layout) made.other_layout = made.samples.layout;
    return made;
  };

  // Several fields a line; the formatter would write one.
  // clang-format off
  constexpr model g_series{
      .word = {}, .name = {}, .bauds = {230400}, .link = two_way, .motor = command, .rates = fixed(5000),
      .frequency = {500, 1200}, .range = {100, 16000}, .turn_deg = 180};
  constexpr model g1 = like(g_series, "g1", "G1", [&](model& m) {
    m.ids = {19}; m.samples.has_angle_replies = true; m.rates = fixed(9000, 280); m.zero_angle_divisor = 4; });
  constexpr model g6 = like(g_series, "g6", "G6", [&](model& m) {
    m.ids = {13}; m.bauds = {512000}; m.samples.layout = half_mm; m.range.max_mm = 25000; m.protection = yes;
    m.rates = {.entries = {{{8000, 100}, {16000, 260}, {18000, 280}}}, .nominal_hz = 18000, .is_settable = true}; });

  constexpr model x3{
      .word = "x3", .name = "X3", .ids = {4, 6}, .bauds = {115200}, .samples = {flagged_mm}, .link = one_way,
      .motor = dtr,
      .rates = {.entries = {{{3000}}}, .nominal_hz = 3000, .least_seen_hz = 2500, .most_seen_hz = 3600},
      .frequency = by_pin("M_SCTR or M_CTR"), .range = {100, 8000}, .protection = no};
  constexpr model x2 = like(x3, "x2", "X2", [&](model& m) {
    m.frequency = by_pin("M_CTR or M_SCTP"); m.usual = usual_kind::of_its_layout; });
  constexpr model s2 = like(x3, "s2", "S2", [&](model& m) {
    m.ids = {4, 12}; m.bauds = {115200, 128000}; m.rates = {.entries = {{{3000}, {4000}, {5000}}}};
    m.range = {80, 12000}; m.ct_information = yes; m.other_layout = intensity_8; });
  // Their bauds carry 3 kHz of such samples, not 4.
  constexpr model s2_intensity = like(s2, "s2-intensity", "S2 with intensity", [&](model& m) {
    m.samples.layout = intensity_8; m.other_layout = flagged_mm; m.rates = fixed(3000); });
  constexpr model s4 = like(x3, "s4", "S4", [&](model& m) {
    m.ids = {4}; m.link = two_way; m.rates = fixed(4000); m.frequency = by_pin("for the speed"); });

  constexpr model t_mini{
      .word = "t-mini", .name = "T-mini", .ids = {140}, .bauds = {230400},
      .samples = {intensity_8, correction_kind::none}, .link = two_way, .motor = command, .rates = fixed(4000),
      .frequency = {600, 1200}, .range = {50, 12000}};
  constexpr model tg15{
      .word = "tg15", .name = "TG15", .ids = {100}, .bauds = {512000},
      .samples = {whole_mm, correction_kind::none, 40, true, all_rate_codes - 1}, .link = two_way, .motor = command,
      .rates = {.entries = {{{10000}, {18000}, {20000}}}, .further_codes_hz = {20000, 10000}},
      .frequency = {.min_chz = 300, .max_chz = 1600, .reply_offset_chz = -40, .ct_offset_chz = 300},
      .range = {50, 30000}, .turn_deg = 180, .zero_angle_divisor = 4, .protection = yes,
      .old_firmware = {.last_version = 0x0102, .layout = half_mm, .zero_angle_divisor = 4}};
  constexpr model tx8 = like(s4, "tx8", "TX8", [&](model& m) {
    m.ids = {100}; m.samples = {whole_mm, correction_kind::none}; m.link = one_way; m.range.min_mm = 50; });

  return std::to_array<model>({
      g4_model,
      like(g4_model, "g4-pro", "G4 Pro", [&](model& m) { m.ids = {7}; m.usual = usual_kind::no; }),
      like(g4_model, "g5", "G5", [&](model& m) {
        m.ids = {20}; m.protection = unknown; m.has_motor_settings = false; m.usual = usual_kind::no; }),
      like(g_series, "f4", "F4", [&](model& m) {
        m.ids = {1}; m.bauds = {115200}; m.rates = fixed(4000); m.range = {120, 12000}; m.protection = no; }),
      like(g_series, "f4-pro", "F4 Pro", [&](model& m) {
        m.ids = {8, 4}; m.rates = {.entries = {{{4000}, {6000}}}, .nominal_hz = 4000, .is_settable = true};
        m.range = {120, 12000}; m.protection = yes; m.has_motor_settings = true; }),
      g1,
      like(g1, "g2", "G2", [&](model& m) {
        m.ids = {15}; m.samples.layout = intensity_10; m.rates = fixed(5000, 280); }),
      like(g1, "g2a", "G2A", [&](model& m) { m.ids = {14}; m.rates = fixed(5000); m.range.max_mm = 12000; }),
      like(g1, "g2c", "G2C", [&](model& m) {
        m.ids = {16}; m.bauds = {115200}; m.rates = fixed(4000); m.range.max_mm = 12000; }),
      like(g_series, "g4c", "G4C", [&](model& m) {
        m.ids = {18}; m.bauds = {115200}; m.rates = fixed(4000); m.range.max_mm = 12000; }),
      like(g_series, "g4b", "G4B", [&](model& m) {
        m.ids = {17}; m.bauds = {512000}; m.samples.layout = intensity_10; m.rates = fixed(10000);
        m.range.min_mm = 120; }),
      like(g1, "r2", "R2", [&](model& m) {
        m.ids = {9}; m.rates = fixed(5000); m.range.min_mm = 120; m.zero_angle_divisor = 100;
        m.old_firmware = {.last_version = 0x0107, .layout = quarter_mm, .zero_angle_divisor = 4}; }),
      g6,
      like(g6, "g7", "G7", [&](model& m) { m.ids = {21}; }),
      like(x3, "x4", "X4", [&](model& m) {
        m.ids = {6}; m.bauds = {128000}; m.link = two_way; m.rates = fixed(5000); m.frequency = by_pin("M_SCTR");
        m.range = {120, 10000}; m.ct_information = no; }),
      like(x3, "x4-pro", "X4 Pro", [&](model& m) {
        m.bauds = {128000}; m.motor = supply; m.rates = fixed(5000); m.frequency = by_pin("M_CTR");
        m.range = {120, 10000}; m.ct_information = yes; m.usual = usual_kind::at_its_rate; }),
      x2,
      like(x2, "x2l", "X2L", [&](model& m) { m.usual = usual_kind::no; }),
      x3,
      like(x3, "x3-pro", "X3 Pro", [&](model& m) {
        m.rates = {.entries = {{{3000}, {4000}}}}; m.usual = usual_kind::at_its_rate; }),
      s2,
      like(s2, "s2-pro", "S2 Pro", [&](model& m) { m.usual = usual_kind::at_its_rate; }),
      s2_intensity,
      like(s2_intensity, "s2-pro-intensity", "S2 Pro with intensity", [&](model& m) {
        m.usual = usual_kind::at_its_rate; }),
      s4,
      like(s4, "s4b", "S4B", [&](model& m) { m.ids = {4, 11}; m.bauds = {153600}; m.samples.layout = intensity_8; }),
      like(s4, "scl", "SCL", [&](model& m) {
        m.ids = {22}; m.samples = {intensity_8, correction_kind::scl}; m.link = one_way; m.rates = fixed(3000);
        m.range.min_mm = 120; }),
      t_mini,
      like(t_mini, "t-mini-pro", "T-mini Pro", [&](model& m) {
        m.ids = {150}; m.range.min_mm = 20; m.usual = usual_kind::of_its_layout; }),
      like(t_mini, "t-mini-plus", "T-mini Plus", [&](model& m) { m.ids = {151}; }),
      like(t_mini, "t-mini-plus-sh", "T-mini Plus SH", [&](model& m) {
        m.ids = {152}; m.samples.layout = intensity_16; m.samples.has_angle_replies = true; m.range.max_mm = 25000;
        m.has_pitch = true; m.usual = usual_kind::of_its_layout; }),
      tg15,
      like(tg15, "tg30", "TG30", [&](model& m) { m.ids = {101}; }),
      like(tg15, "tg50", "TG50", [&](model& m) { m.ids = {102}; m.range.max_mm = 50000; }),
      tx8,
      like(tx8, "tx20", "TX20", [&](model& m) { m.range.max_mm = 20000; }),
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
[[nodiscard]] constexpr std::string_view article_of(const model& model) noexcept {
  return std::string_view("FRSX").find(model.name.front()) != std::string_view::npos ? "an" : "a";
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
  const auto& [min_chz, max_chz, reply_offset, ct_offset, pin] = row.frequency;
  const bool has_limits = 0 < row.range.min_mm && row.range.min_mm < row.range.max_mm &&
                          (min_chz < max_chz || max_chz == 0) && pin.empty() == (max_chz != 0);
  const bool has_names = !row.word.empty() && !row.name.empty() && row.bauds[0] != 0 &&
                         row.ids[0] != 0 && row.ids[0] != row.ids[1];
  const bool has_memory = row.samples.max_samples > 0 && has_room_for(row, row.samples.layout) &&
                          has_room_for(row, row.other_layout);
  const firmware_difference& old = row.old_firmware;
  const bool is_parsed =
      old.last_version == 0 || (sample_size(old.layout) == sample_size(row.samples.layout) &&
                                (old.zero_angle_divisor != 0) == (row.zero_angle_divisor != 0));
  const bool takes_commands = row.motor == motor_kind::command || row.rates.is_settable ||
                              max_chz != 0 || row.zero_angle_divisor != 0 || row.has_pitch ||
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
    each->frequency.ct_offset_chz = old.ct_offset_chz;
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

/// Whether the packets of a device of the model `row` can be valid where `lidar_model` is read. *Pure.*
[[nodiscard]] constexpr bool is_read_as(const model& row, const model& lidar_model) noexcept {
  const bool has_baud = std::any_of(row.bauds.begin(), row.bauds.end(), [&](std::uint32_t baud) {
    return baud != 0 && (baud == lidar_model.bauds[0] || baud == lidar_model.bauds[1]);
  });
  return has_baud && sample_size(row.samples.layout) == sample_size(lidar_model.samples.layout);
}

}  // namespace detail

/// The model `lidar_model` of the table, as a device of it is that has reported `information`: with old firmware another
/// record, of the same name. Valid forever; `lidar_model` itself if nothing differs. *Pure.*
// NOLINTBEGIN(bugprone-return-const-ref-from-parameter): models are those of the table
[[nodiscard]] constexpr const model& with_firmware(const model& lidar_model,
                                                   const device_information& information) noexcept {
  const unsigned version = information.firmware_major * 256U + information.firmware_minor;
  if (!lidar_model.has_number(information.model) || version > lidar_model.old_firmware.last_version)
    return lidar_model;
  for (const model& each : detail::old_models) {
    if (each == lidar_model) return each;
  }
  return lidar_model;
}
// NOLINTEND(bugprone-return-const-ref-from-parameter)

/// The model to which a one-way lidar that identifies itself with `number` belongs instead of `lidar_model`; null
/// if it may be `lidar_model`. Several models report 4 and 6, so these numbers contradict no one-way model. Valid
/// forever. *Pure.*
[[nodiscard]] constexpr const model* one_way_other_than(const model& lidar_model,
                                                        std::uint8_t number) noexcept {
  if (detail::may_report(lidar_model, number)) return nullptr;
  const model* found = nullptr;
  for (const model& each : models) {
    if (each.link != link_kind::one_way || !detail::may_report(each, number)) continue;
    if (found != nullptr && found->ids != each.ids) return nullptr;
    if (found == nullptr) found = &each;
  }
  if (found != nullptr) return found;
  for (const model& each : models) {
    if (detail::may_report(each, number) && detail::is_read_as(each, lidar_model)) return &each;
  }
  return nullptr;
}

}  // namespace g4lidar
