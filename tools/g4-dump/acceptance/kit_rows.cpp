// SPDX-License-Identifier: MIT
// The steps and the queries.
#include "kit_rows.hpp"

#include <algorithm>
#include <array>

namespace g4_tool::acceptance {
namespace {

bool is_g(const model& row) noexcept {
  return row.link == link_kind::two_way && row.motor == motor_kind::command;
}
presence when(bool has) noexcept { return has ? presence::yes : presence::no; }
presence unknown_of_g(const model& row) noexcept {
  return is_g(row) ? presence::unknown : presence::no;
}

constexpr std::array all_queries{
    query_row{0x91, "health_91", 3, [](const model&) { return presence::unknown; }},
    query_row{0x92, "health_92", 3, [](const model&) { return presence::unknown; }},
    query_row{0x0D, "frequency_0d", 4,
              [](const model& row) { return when(row.frequency.max_chz != 0); }},
    query_row{
        0xD1, "sample_rate_d1", 1,
        [](const model& row) { return row.rates.is_settable ? presence::yes : unknown_of_g(row); }},
    query_row{0x93, "zero_angle_93", 4,
              [](const model& row) { return when(row.zero_angle_divisor != 0); }},
    query_row{0x98, "pitch_98", 4,
              [](const model& row) { return row.has_pitch ? presence::yes : unknown_of_g(row); }},
    query_row{0x05, "low_power_05", 1, unknown_of_g},
    query_row{0x08, "direction_08", 1, unknown_of_g},
};

bool always(const tested_lidar& /*lidar*/) noexcept { return true; }
bool may_have_protection(const tested_lidar& lidar) noexcept {
  return lidar.is_two_way() && lidar.row.protection != presence::no;
}
bool sets_frequency(const tested_lidar& lidar) noexcept { return lidar.row.frequency.max_chz != 0; }
bool sets_rate(const tested_lidar& lidar) noexcept { return lidar.row.rates.is_settable; }
bool takes_commands(const tested_lidar& lidar) noexcept { return lidar.is_two_way(); }
bool has_scan(const tested_lidar& lidar) noexcept {
  return lidar.surveyed && lidar.surveyed->counts.packets > 0;
}
bool has_target(const tested_lidar& lidar) noexcept { return lidar.target_degree.has_value(); }

constexpr std::string_view no_scan = "There were no packets.";

constexpr std::array steps{
    step_row{step::bridge, "bridge", always, "", bridge},
    step_row{step::listening, "listening", always, "", listening},
    step_row{step::identity, "identity", always, "", identity},
    step_row{step::queries, "queries", always, "", queries},
    step_row{step::protection, "protection", may_have_protection, "The model does not have it.",
             protection, setting::protection},
    step_row{step::frequency, "frequency", sets_frequency, "The model has no command for it.",
             frequency, setting::frequency},
    step_row{step::sample_rate, "sample_rate", sets_rate,
             "The model has one sample rate, or no command for it.", sample_rate,
             setting::sample_rate},
    step_row{step::start_and_stop, "start_and_stop", takes_commands, "The model takes no commands.",
             start_and_stop},
    step_row{step::dtr, "dtr", always, "", dtr},
    step_row{step::stream, "stream", always, "", stream},
    step_row{step::sample_bits, "sample_bits", has_scan, no_scan, sample_bits},
    step_row{step::ct_information, "ct_information", has_scan, no_scan, ct_information},
    step_row{step::time_packets, "time_packets", has_scan, no_scan, time_packets},
    step_row{step::near_target, "near_target", always, "", near_target},
    step_row{step::far_target, "far_target", has_target, "There was no near target.", far_target},
    step_row{step::unplug, "unplug", always, "", lose_and_return, setting::frequency},
};

static_assert(steps.size() == step_count && std::ranges::is_sorted(steps, {}, &step_row::of));

}  // namespace

std::span<const step_row> step_rows() noexcept { return steps; }
std::span<const query_row> query_rows() noexcept { return all_queries; }

std::string_view name_of(step step) noexcept {
  return steps.at(static_cast<std::size_t>(step)).name;
}

}  // namespace g4_tool::acceptance
