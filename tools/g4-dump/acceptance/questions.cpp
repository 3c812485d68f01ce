// SPDX-License-Identifier: MIT
// The open questions, and what the facts of a run show about them.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "kit_rows.hpp"

namespace g4_tool::acceptance {
namespace {

bool any(const model& /*which*/) noexcept { return true; }
bool two_way(const model& model) noexcept { return model.link == link_kind::two_way; }
bool one_way(const model& model) noexcept { return !two_way(model); }
bool sets_frequency(const model& model) noexcept { return model.frequency.max_chz != 0; }
bool sets_rate(const model& model) noexcept { return model.rates.is_settable; }
bool has_dtr(const model& model) noexcept { return model.motor == motor_kind::dtr; }
bool has_offset(const model& model) noexcept { return model.zero_angle_divisor != 0; }
bool has_flags(const model& model) noexcept { return has_sample_flags(model.samples.layout); }
bool may_have_protection(const model& model) noexcept {
  return two_way(model) && model.protection != presence::no;
}

constexpr std::array questions{
    question_row{"Which USB bridge is used, and which baud rate does it really set?",
                 step::bridge,
                 any,
                 {"usb", "wanted_baud", "set_baud"}},
    question_row{
        "Which models send before they are asked, and what?", step::listening, any, {"unasked"}},
    question_row{
        "With which number does the device identify itself?", step::identity, any, {"number"}},
    question_row{
        "Does a one-way lidar answer any query?", step::queries, one_way, {"queries_answered"}},
    question_row{"Are the rate (D1), the direction (08) and low power (05) answered?",
                 step::queries,
                 two_way,
                 {"sample_rate_d1", "direction_08", "low_power_05"}},
    question_row{"What does the offset of zero (93) contain?",
                 step::queries,
                 has_offset,
                 {"zero_offset_deg", "zero_angle_93"}},
    question_row{
        "Which error codes does the health contain?", step::queries, two_way, {"health_error"}},
    question_row{"Is there power-down protection (D9)?",
                 step::protection,
                 may_have_protection,
                 {"answers_d9"}},
    question_row{"What is answered at the limits of the scan frequency?",
                 step::frequency,
                 sets_frequency,
                 {"lowest_hz", "highest_hz"}},
    question_row{"Which sample rate is behind each code?",
                 step::sample_rate,
                 sets_rate,
                 {"codes", "code_0_hz", "code_1_hz", "code_2_hz"}},
    question_row{"How long are the packets at each sample rate?",
                 step::sample_rate,
                 any,
                 {"most_samples", "code_0_samples", "code_1_samples", "code_2_samples"}},
    question_row{
        "Does the command 00 alone stop the scan?", step::start_and_stop, two_way, {"stops_by_00"}},
    question_row{"How long does the motor spin up?",
                 step::start_and_stop,
                 any,
                 {"steady_after_ms", "first_packet_ms"}},
    question_row{
        "Does an edge of DTR start the motor, or its level?", step::dtr, has_dtr, {"starts_by"}},
    question_row{"Does DTR switch the motor, or the supply of the whole lidar?",
                 step::dtr,
                 has_dtr,
                 {"dtr_switches"}},
    question_row{"Do zero packets report the frequency, and with which offset?",
                 step::stream,
                 any,
                 {"reports_frequency", "offset_hz"}},
    question_row{
        "Do all packets have the layout of the table?", step::stream, any, {"damaged_percent"}},
    question_row{"Are the two lower bits of a sample flags, intensity or range?",
                 step::sample_bits,
                 any,
                 {"lower_bits"}},
    question_row{"What do the flags 1, 2 and 3 mean?", step::sample_bits, has_flags, {}},
    question_row{"Do the CT bytes contain information, and does a CRC byte follow?",
                 step::ct_information,
                 any,
                 {"information", "crc_byte"}},
    question_row{"Are there time packets?", step::time_packets, any, {"time_packets"}},
    question_row{"Where is zero, and is the offset of 93 already applied?",
                 step::near_target,
                 any,
                 {"zero_is_at_deg", "offset_is"}},
    question_row{
        "Is the unit of the range that of the table?", step::far_target, any, {"range_ratio"}},
    question_row{"Do the settings outlive a loss of power?",
                 step::unplug,
                 sets_frequency,
                 {"settings_kept"}},
};

/// The fact as the last step that states it does; null if none does.
const evidence* fact_of(std::span<const step_result> results, std::string_view name) {
  const evidence* last = nullptr;
  for (const step_result& each : results) {
    const auto found = std::ranges::find(each.facts, name, &evidence::name);
    if (found != each.facts.end()) last = &*found;
  }
  return last;
}

}  // namespace

std::span<const question_row> question_rows() noexcept { return questions; }

std::vector<question_answer> answers_of(const model& model, std::span<const step_result> results) {
  using enum question_answer::state;
  std::vector<question_answer> all;
  for (const question_row& row : questions) {
    std::string facts;
    for (const std::string_view name : row.answered_by) {
      const evidence* const fact = fact_of(results, name);
      if (fact == nullptr && facts.empty()) break;
      if (fact != nullptr)
        facts += fmt::format("{}{} {}", facts.empty() ? "" : ", ", name, fact->text());
    }
    const auto done = std::ranges::find(results, row.asked_by, &step_result::of);
    if (!facts.empty()) {
      all.push_back({answered, facts});
    } else if (!row.arises(model)) {
      all.push_back({does_not_arise, "Not with this model."});
    } else {
      all.push_back({open, done == results.end() ? "The step was not done." : done->text});
    }
  }
  return all;
}

}  // namespace g4_tool::acceptance
