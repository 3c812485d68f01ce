// SPDX-License-Identifier: MIT
// The models of the family, as a simulated lidar needs them. Made from what is known of the devices,
// and not from the table of the core, so that a wrong row does not hide in both.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/scanner.hpp"

namespace g4lidar::sim {

/// Whether a model has something, as far as it is known.
enum class knowledge : std::uint8_t { absent, present, unknown };

/// When a device answers queries.
enum class talk : std::uint8_t { never, while_idle, always };

/// What a device sends before a zero packet.
enum class leading_byte : std::uint8_t { nothing, random, crc };

inline constexpr sample_code quarter_code{0, 4, lower_bits::range};
inline constexpr sample_code flagged_code{0, 1, lower_bits::flags};
inline constexpr sample_code half_code{0, 2, lower_bits::range};
inline constexpr sample_code mm_code{0, 1, lower_bits::range};
inline constexpr sample_code bright_10_code{1, 1, lower_bits::intensity};
inline constexpr sample_code bright_8_code{1, 1, lower_bits::flags};
inline constexpr sample_code bright_16_code{2, 1, lower_bits::range};

struct rate_row {
  std::uint32_t hz = 0;          ///< 0: none.
  std::uint16_t nearest_mm = 0;  ///< At this rate; 0: that of the model.
};

struct rate_table {
  std::array<rate_row, 3> rows{};
  std::uint32_t usual_hz = 0;  ///< Of these, as delivered; 0: not known.
  bool are_stepped = false;    ///< By D0.
  /// What some devices answer to D1 for these rows.
  std::array<std::uint8_t, 3> other_codes{0, 1, 2};
};

/// The scan frequency, in 0.01 Hz.
struct frequency_row {
  std::uint16_t slowest_chz = 500;
  std::uint16_t fastest_chz = 1200;
  bool is_stepped = true;              ///< By 09 to 0C.
  bool is_reported = true;             ///< In zero packets.
  std::int16_t answer_offset_chz = 0;  ///< To be added to answers.
  std::int16_t ct_offset_chz = 0;      ///< To be added to zero packets.
};

struct range_row {
  std::uint16_t nearest_mm = 100;
  std::uint16_t farthest_mm = 16'000;
};

/// The commands beyond those of all models that answer, D0 and D1, and the scan frequency.
struct command_row {
  bool idle = false;                          ///< 01, 02.
  bool idle_query = false;                    ///< 05.
  bool motor = false;                         ///< 06, 07, 08, 0E, 0F.
  bool rate_query_only = false;               ///< D1, as far as it is known.
  bool pitch = false;                         ///< 98.
  std::uint8_t zero_divisor = 0;              ///< Of the answer to 93; 0: no such command.
  knowledge protection = knowledge::unknown;  ///< D9.
};

/// What the answer to 90 contains.
struct version_row {
  std::uint8_t major = 3;
  std::uint8_t minor = 2;
  std::uint8_t hardware = 3;
};

/// What devices with old firmware have instead.
struct old_version {
  std::uint16_t last = 0;  ///< 256 * major + minor; 0: no difference.
  sample_code code{};
  std::uint8_t zero_divisor = 0;
  std::int16_t ct_offset_chz = 0;
};

/// By default what most models of the G series have.
struct simulated_model {
  std::string_view word;
  std::array<std::uint8_t, 2> ids{};  ///< In the device information; 0: no other.
  version_row version{};
  std::array<std::uint32_t, 2> bauds{230'400};  ///< The usual one first; 0: no other.

  sample_code code = quarter_code;
  beam_shape beam = triangle_beam;
  std::uint8_t max_samples = 40;
  std::uint8_t usual_flags = 0;
  std::optional<sample_code> other_code{};  ///< Of some devices.

  talk answers = talk::while_idle;
  drive driven_by = drive::commands;

  rate_table rates{};
  frequency_row frequency{};
  std::uint16_t index_deg = 0;  ///< Where a revolution begins.
  range_row range{};
  bool is_turned = true;

  command_row commands{};
  knowledge information = knowledge::unknown;  ///< In CT.
  leading_byte leading = leading_byte::nothing;
  old_version old{};
};

namespace rows {

// `model` with another name and other ids.
[[nodiscard]] constexpr simulated_model named(simulated_model model, std::string_view word,
                                              std::uint8_t id, std::uint8_t other_id = 0) noexcept {
  model.word = word;
  model.ids = {id, other_id};
  return model;
}

[[nodiscard]] constexpr simulated_model with_range(simulated_model model, std::uint16_t nearest_mm,
                                                   std::uint16_t farthest_mm) noexcept {
  model.range = {nearest_mm, farthest_mm};
  return model;
}

[[nodiscard]] constexpr simulated_model with_rate(simulated_model model,
                                                  std::uint32_t hz) noexcept {
  model.rates = {{{{hz}}}, hz};
  return model;
}

[[nodiscard]] constexpr simulated_model with_baud(simulated_model model,
                                                  std::uint32_t baud) noexcept {
  model.bauds = {baud};
  return model;
}

[[nodiscard]] constexpr simulated_model with_zero_angle(simulated_model model,
                                                        std::uint8_t divisor) noexcept {
  model.commands.zero_divisor = divisor;
  return model;
}

// G4, G4 Pro, G5, and the models that differ from them in some numbers.
inline constexpr auto g_models = [] {
  simulated_model g4{.word = "g4", .ids = {5}};
  g4.max_samples = 80;
  g4.rates = {{{{4000, 100}, {8000, 260}, {9000, 280}}}, 9000, true};
  g4.commands.protection = knowledge::present;
  g4.commands.idle = g4.commands.idle_query = g4.commands.motor = true;
  g4.leading = leading_byte::random;
  g4.answers = talk::always;
  simulated_model g5 = named(g4, "g5", 20);
  g5.commands = {};

  simulated_model f4 = with_baud(with_rate(with_range({}, 120, 12'000), 4000), 115'200);
  f4.commands.protection = knowledge::absent;
  simulated_model f4_pro = with_range({}, 120, 12'000);
  f4_pro.rates = {{{{4000}, {6000}}}, 4000, true};
  f4_pro.commands.protection = knowledge::present;
  f4_pro.commands.idle = f4_pro.commands.motor = true;

  simulated_model g1 = with_zero_angle(with_rate({}, 9000), 4);
  g1.rates.rows[0].nearest_mm = 280;
  const simulated_model g2a = with_zero_angle(with_rate(with_range({}, 100, 12'000), 5000), 4);
  const simulated_model g2c = with_baud(with_rate(g2a, 4000), 115'200);
  const simulated_model g4c = with_zero_angle(g2c, 0);
  simulated_model r2 = with_zero_angle(with_rate(with_range({}, 120, 16'000), 5000), 100);
  r2.old = {0x0107, quarter_code, 4, 0};

  simulated_model g6 = with_baud(with_range({}, 100, 25'000), 512'000);
  g6.code = half_code;
  g6.rates = {{{{8000, 100}, {16'000, 260}, {18'000, 280}}}, 18'000, true};
  g6.commands.protection = knowledge::present;

  simulated_model g2 = with_zero_angle(with_rate({}, 5000), 4);
  g2.code = bright_10_code;
  g2.version = {3, 5, 3};
  g2.rates.rows[0].nearest_mm = 280;
  simulated_model g4b = with_baud(with_rate(with_range({}, 120, 16'000), 10'000), 512'000);
  g4b.code = bright_10_code;

  return std::array{
      g4,
      named(g4, "g4-pro", 7),
      g5,
      named(f4, "f4", 1),
      named(f4_pro, "f4-pro", 8, 4),
      named(g1, "g1", 19),
      named(g2, "g2", 15),
      named(g2a, "g2a", 14),
      named(g2c, "g2c", 16),
      named(g4c, "g4c", 18),
      named(g4b, "g4b", 17),
      named(r2, "r2", 9),
      named(g6, "g6", 13),
      named(g6, "g7", 21),
  };
}();

// The X and S models, and the SCL: no commands beyond start, stop and questions, or none at all.
inline constexpr auto x_models = [] {
  simulated_model x4 = with_baud(with_rate(with_range({}, 120, 10'000), 5000), 128'000);
  x4.code = flagged_code;
  x4.driven_by = drive::dtr_line;
  x4.frequency.is_stepped = false;
  x4.is_turned = false;
  x4.commands.protection = knowledge::absent;
  x4.version = {1, 10, 1};
  const simulated_model s4 = with_baud(with_rate(with_range(x4, 100, 8000), 4000), 115'200);
  x4.information = knowledge::absent;
  x4.index_deg = 348;
  x4.frequency.is_reported = false;

  simulated_model one_way = s4;
  one_way.answers = talk::never;
  one_way.version = {1, 5, 1};
  one_way.frequency.slowest_chz = 400;
  one_way.frequency.fastest_chz = 800;
  const simulated_model x2 = with_rate(one_way, 3000);

  simulated_model x3_pro = one_way;
  x3_pro.rates = {{{{3000}, {4000}}}};
  x3_pro.frequency.slowest_chz = 600;
  x3_pro.frequency.fastest_chz = 1200;

  simulated_model informing = one_way;
  informing.information = knowledge::present;
  informing.leading = leading_byte::crc;
  informing.version = {3, 1, 3};
  simulated_model x4_pro = with_baud(with_rate(with_range(informing, 120, 10'000), 5000), 128'000);
  x4_pro.driven_by = drive::power;
  x4_pro.frequency.slowest_chz = 500;
  x4_pro.frequency.fastest_chz = 1200;
  simulated_model s2 = with_range(informing, 80, 12'000);
  s2.bauds = {115'200, 128'000};
  s2.rates = {{{{3000}, {4000}, {5000}}}};
  s2.other_code = bright_8_code;
  simulated_model bright_s2 = with_rate(s2, 3000);  // 4 kHz need more than 128000 baud
  bright_s2.code = bright_8_code;
  bright_s2.other_code = flagged_code;

  simulated_model s4b = with_baud(s4, 153'600);
  s4b.code = bright_8_code;
  simulated_model scl = with_range(x2, 120, 8000);
  scl.code = bright_8_code;
  scl.beam = scl_beam;

  return std::array{
      named(x4, "x4", 6),
      named(x4_pro, "x4-pro", 4, 6),
      named(x2, "x2", 4, 6),
      named(x2, "x2l", 4, 6),
      named(x2, "x3", 4, 6),
      named(x3_pro, "x3-pro", 4, 6),
      named(s2, "s2", 4, 12),
      named(s2, "s2-pro", 4, 12),
      named(bright_s2, "s2-intensity", 4, 12),
      named(bright_s2, "s2-pro-intensity", 4, 12),
      named(s4, "s4", 4),
      named(s4b, "s4b", 4, 11),
      named(scl, "scl", 22),
  };
}();

// Those that measure the time of flight.
inline constexpr auto time_of_flight_models = [] {
  simulated_model straight{};
  straight.beam = straight_beam;

  simulated_model t_mini = with_rate(straight, 4000);
  t_mini.code = bright_8_code;
  t_mini.usual_flags = 2;
  t_mini.version = {1, 3, 1};
  t_mini.frequency.slowest_chz = 600;
  t_mini.is_turned = false;
  simulated_model sh = with_range(t_mini, 50, 25'000);
  sh.code = bright_16_code;
  sh.usual_flags = 0;
  sh.commands.pitch = true;

  simulated_model tg = with_baud(with_zero_angle(straight, 4), 512'000);
  tg.code = mm_code;
  tg.rates = {{{{10'000}, {18'000}, {20'000}}}};
  tg.rates.other_codes = {4, 1, 3};
  tg.frequency.slowest_chz = 300;
  tg.frequency.fastest_chz = 1600;
  tg.index_deg = 108;
  tg.commands.rate_query_only = true;
  tg.commands.protection = knowledge::present;
  tg.leading = leading_byte::crc;
  tg.frequency.answer_offset_chz = -40;
  tg.frequency.ct_offset_chz = 300;
  tg.old = {0x0102, half_code, 4, 0};

  simulated_model tx = with_baud(with_rate(straight, 4000), 115'200);
  tx.code = mm_code;
  tx.answers = talk::never;
  tx.driven_by = drive::dtr_line;
  tx.frequency.slowest_chz = 400;
  tx.frequency.fastest_chz = 800;
  tx.frequency.is_stepped = false;
  tx.is_turned = false;
  tx.commands.protection = knowledge::absent;

  return std::array{
      named(with_range(t_mini, 50, 12'000), "t-mini", 140),
      named(with_range(t_mini, 20, 12'000), "t-mini-pro", 150),
      named(with_range(t_mini, 50, 12'000), "t-mini-plus", 151),
      named(sh, "t-mini-plus-sh", 152),
      named(with_range(tg, 50, 30'000), "tg15", 100),
      named(with_range(tg, 50, 30'000), "tg30", 101),
      named(with_range(tg, 50, 50'000), "tg50", 102),
      named(with_range(tx, 50, 8000), "tx8", 100),
      named(with_range(tx, 50, 20'000), "tx20", 100),
  };
}();

}  // namespace rows

/// All models, the G4 first.
inline constexpr auto simulated_models = [] {
  std::array<simulated_model,
             rows::g_models.size() + rows::x_models.size() + rows::time_of_flight_models.size()>
      all{};
  auto end = std::copy(rows::g_models.begin(), rows::g_models.end(), all.begin());
  end = std::copy(rows::x_models.begin(), rows::x_models.end(), end);
  std::copy(rows::time_of_flight_models.begin(), rows::time_of_flight_models.end(), end);
  return all;
}();

}  // namespace g4lidar::sim
