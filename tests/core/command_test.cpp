// SPDX-License-Identifier: MIT
// All commands of the protocol's table: their bytes, their responses, and their properties.
#include "g4lidar/core/command.hpp"
#include "g4lidar/core/response.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <set>

namespace g4lidar {
namespace {

struct row {
  std::uint8_t code;
  command name;
  reply answered_by;
  int fixed_answer;  // -1: none
  bool moves_state;
  bool allowed_while_scanning;
};

/// The table of the protocol page, in its order.
constexpr std::array<row, 26> table{{
    {0x60, command::start, reply::scan_started, -1, false, true},
    {0x65, command::stop, reply::none, -1, false, true},
    {0x00, command::forced_stop, reply::none, -1, false, true},
    {0x90, command::device_info, reply::device_info, -1, false, false},
    {0x91, command::health, reply::health, -1, false, false},
    {0x92, command::health_vendor, reply::health, -1, false, false},
    {0x01, command::low_power_on, reply::byte, 1, false, false},
    {0x02, command::low_power_off, reply::byte, 0, false, false},
    {0x05, command::low_power_query, reply::byte, -1, false, false},
    {0x06, command::motor_clockwise, reply::byte, 0, false, false},
    {0x07, command::motor_counter_clockwise, reply::byte, 1, false, false},
    {0x08, command::motor_direction_query, reply::byte, -1, false, false},
    {0x09, command::frequency_up_0_1_hz, reply::frequency, -1, true, false},
    {0x0A, command::frequency_down_0_1_hz, reply::frequency, -1, true, false},
    {0x0B, command::frequency_up_1_hz, reply::frequency, -1, true, false},
    {0x0C, command::frequency_down_1_hz, reply::frequency, -1, true, false},
    {0x0D, command::frequency_query, reply::frequency, -1, false, false},
    {0x0E, command::constant_frequency_on, reply::byte, 1, false, false},
    {0x0F, command::constant_frequency_off, reply::byte, 0, false, false},
    {0x93, command::zero_angle, reply::frequency, -1, false, false},
    {0x98, command::pitch, reply::pitch, -1, false, false},
    {0xD0, command::sample_rate_next, reply::byte, -1, true, false},
    {0xD1, command::sample_rate_query, reply::byte, -1, false, false},
    {0xD9, command::protection_toggle, reply::byte, -1, true, false},
    {0x80, command::restart, reply::none, -1, false, false},
    {0x40, command::restart_old, reply::none, -1, false, false},
}};

constexpr bool agrees(const row& r) {
  const auto traits = traits_of(static_cast<command>(r.code));
  const int fixed = traits && traits->fixed_answer ? *traits->fixed_answer : -1;
  return traits && static_cast<std::uint8_t>(r.name) == r.code && traits->code == r.name &&
         traits->answered_by == r.answered_by && fixed == r.fixed_answer &&
         traits->moves_state == r.moves_state &&
         traits->allowed_while_scanning == r.allowed_while_scanning &&
         encode(r.name) == std::array<std::uint8_t, 2>{0xA5, r.code};
}

constexpr bool all_agree() {
  for (const row& r : table) {
    if (!agrees(r)) return false;
  }
  return true;
}
static_assert(all_agree());
static_assert(commands.size() == table.size());

TEST(Command, AgreesWithTheProtocolsTable) {
  for (const row& r : table) EXPECT_TRUE(agrees(r)) << std::hex << int{r.code};
}

TEST(Command, OtherBytes_AreNoCommand) {
  std::set<unsigned> known;
  for (const row& r : table) known.insert(r.code);
  EXPECT_EQ(known.size(), 26U);
  for (unsigned code = 0; code < 256; ++code) {
    EXPECT_EQ(traits_of(static_cast<command>(code)).has_value(), known.count(code) == 1) << code;
  }
}

TEST(Command, AnswersOfOneByte) {
  static_assert(reply_byte<sample_rate>(0) == sample_rate::khz_4);
  static_assert(reply_byte<sample_rate>(1) == sample_rate::khz_8);
  static_assert(reply_byte<sample_rate>(2) == sample_rate::khz_9);
  static_assert(reply_byte<power_down_protection>(0) == power_down_protection::on);
  static_assert(reply_byte<power_down_protection>(1) == power_down_protection::off);
  static_assert(reply_byte<motor_direction>(0) == motor_direction::clockwise);
  static_assert(reply_byte<motor_direction>(1) == motor_direction::counter_clockwise);
  static_assert(reply_byte<low_power>(0) == low_power::off);
  static_assert(reply_byte<low_power>(1) == low_power::on);
  static_assert(reply_byte<constant_frequency>(0) == constant_frequency::off);
  static_assert(reply_byte<constant_frequency>(1) == constant_frequency::on);
  for (unsigned value = 2; value < 256; ++value) {
    const auto byte = static_cast<std::uint8_t>(value);
    EXPECT_EQ(reply_byte<sample_rate>(byte).has_value(), value == 2);
    EXPECT_FALSE(reply_byte<power_down_protection>(byte));
    EXPECT_FALSE(reply_byte<motor_direction>(byte));
    EXPECT_FALSE(reply_byte<low_power>(byte));
    EXPECT_FALSE(reply_byte<constant_frequency>(byte));
  }
}

TEST(Command, Rates) {
  EXPECT_EQ(to_hz(sample_rate::khz_4), 4000U);
  EXPECT_EQ(to_hz(sample_rate::khz_8), 8000U);
  EXPECT_EQ(to_hz(sample_rate::khz_9), 9000U);
}

}  // namespace
}  // namespace g4lidar
