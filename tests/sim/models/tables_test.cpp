// SPDX-License-Identifier: MIT
// The table of the simulator and that of the core, each made from what is known of the devices: they
// must agree in every field that both have.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "g4lidar/core/model.hpp"
#include "sim/device/models.hpp"

namespace g4lidar {
namespace {

std::string text_of(presence what) {
  return what == presence::yes ? "yes" : what == presence::no ? "no" : "unknown";
}
std::string text_of(sim::knowledge what) {
  return what == sim::knowledge::present  ? "yes"
         : what == sim::knowledge::absent ? "no"
                                          : "unknown";
}

std::string text_of(motor_kind what) {
  return what == motor_kind::command ? "commands" : what == motor_kind::dtr ? "dtr" : "supply";
}
std::string text_of(sim::drive what) {
  return what == sim::drive::commands   ? "commands"
         : what == sim::drive::dtr_line ? "dtr"
                                        : "supply";
}

std::string text_of(correction_kind what) {
  return what == correction_kind::triangle ? "21.8 155.3"
         : what == correction_kind::scl    ? "17.8 far"
                                           : "none";
}
std::string text_of(const sim::beam_shape& shape) {
  if (shape.offset_mm == 0.0 && shape.slope == 0.0) return "none";
  const std::string offset = std::to_string(shape.offset_mm).substr(0, 4);
  if (shape.slope == 0.0) return offset + " far";
  return offset + " " + std::to_string(shape.offset_mm / shape.slope).substr(0, 5);
}

/// Bytes, the value of the lowest bit of the word in mm / 4, and what the lower two bits are.
std::string text_of(sample_layout what) {
  switch (what) {
    case sample_layout::quarter_mm:
      return "2 bytes, 1 range";
    case sample_layout::flagged_mm:
      return "2 bytes, 1 flags";
    case sample_layout::half_mm:
      return "2 bytes, 2 range";
    case sample_layout::whole_mm:
      return "2 bytes, 4 range";
    case sample_layout::intensity_10:
      return "3 bytes, 1 intensity";
    case sample_layout::intensity_8:
      return "3 bytes, 1 flags";
    case sample_layout::intensity_16:
      return "4 bytes, 4 range";
  }
  return "";
}
std::string text_of(const sim::sample_code& code) {
  const unsigned lowest = 4U / code.units_per_mm;
  const bool is_range = code.lower == sim::lower_bits::range;
  return std::to_string(code.size()) + " bytes, " + std::to_string(is_range ? lowest : lowest / 4) +
         (is_range                               ? " range"
          : code.lower == sim::lower_bits::flags ? " flags"
                                                 : " intensity");
}

TEST(SimModelTables, AgreeInEachField) {
  EXPECT_EQ(sim::simulated_models.size(), models.size());
  for (const model& ours : models) {
    const auto* const found =
        std::ranges::find(sim::simulated_models, ours.word, &sim::simulated_model::word);
    ASSERT_NE(found, sim::simulated_models.end()) << ours.word << " is not simulated";
    const sim::simulated_model& its = *found;
    const auto same = [&](const char* field, const auto& in_core, const auto& in_sim) {
      EXPECT_EQ(in_core, in_sim) << field << " of " << ours.word
                                 << ": first that of the core, then that of the simulator";
    };
    same("ids[0]", ours.ids[0], its.ids[0]);
    same("ids[1]", ours.ids[1], its.ids[1]);
    same("bauds[0]", ours.bauds[0], its.bauds[0]);
    same("bauds[1]", ours.bauds[1], its.bauds[1]);
    same("layout", text_of(ours.samples.layout), text_of(its.code));
    same("other layout", text_of(ours.other_layout), text_of(its.other_code.value_or(its.code)));
    same("correction", text_of(ours.samples.correction), text_of(its.beam));
    same("max_samples", ours.samples.max_samples, its.max_samples);
    same("link", ours.link == link_kind::two_way, its.answers != sim::talk::never);
    same("motor", text_of(ours.motor), text_of(its.driven_by));
    for (std::size_t i = 0; i < 3; ++i) {
      same("rate", ours.rates.entries[i].hz, its.rates.rows[i].hz);
      same("shortest range by rate", ours.rates.entries[i].shortest_mm,
           its.rates.rows[i].nearest_mm);
    }
    for (std::uint8_t i = 0; i < 3; ++i) {
      same("rate of another code", rate_hz_of_code(ours, its.rates.other_codes[i]),
           its.rates.rows[i].hz);
    }
    same("nominal rate", ours.rates.nominal_hz, its.rates.usual_hz);
    same("is_settable", ours.rates.is_settable, its.rates.are_stepped);
    same("whether the frequency can be set", ours.frequency.max_chz != 0, its.frequency.is_stepped);
    if (its.frequency.is_stepped) {
      same("min_chz", ours.frequency.min_chz, its.frequency.slowest_chz);
      same("max_chz", ours.frequency.max_chz, its.frequency.fastest_chz);
    }
    same("reply_offset_chz", ours.frequency.reply_offset_chz, its.frequency.answer_offset_chz);
    same("ct_offset_chz", ours.frequency.ct_offset_chz, its.frequency.ct_offset_chz);
    same("min_mm", ours.range.min_mm, its.range.nearest_mm);
    same("max_mm", ours.range.max_mm, its.range.farthest_mm);
    same("turn_deg", int{ours.turn_deg}, its.is_turned ? 180 : 0);
    same("zero_angle_divisor", ours.zero_angle_divisor, its.commands.zero_divisor);
    same("has_motor_settings", ours.has_motor_settings, its.commands.motor);
    same("idle power", ours.has_motor_settings, its.commands.idle);
    same("has_pitch", ours.has_pitch, its.commands.pitch);
    same("protection", text_of(ours.protection), text_of(its.commands.protection));
    same("ct_information", text_of(ours.ct_information), text_of(its.information));
    same("last old firmware", ours.old_firmware.last_version, its.old.last);
    if (its.old.last == 0) continue;
    same("old layout", text_of(ours.old_firmware.layout), text_of(its.old.code));
    same("old ct_offset_chz", ours.old_firmware.ct_offset_chz, its.old.ct_offset_chz);
    same("old zero_angle_divisor", ours.old_firmware.zero_angle_divisor, its.old.zero_divisor);
  }
}

}  // namespace
}  // namespace g4lidar
