// SPDX-License-Identifier: MIT
// The open questions, and what the results of a run show about them.
#include <algorithm>
#include <array>

#include "g4lidar/diagnostics/acceptance.hpp"

namespace g4lidar {
namespace {

using q = acceptance_question;
using step = acceptance_step;

constexpr std::array questions{
    open_question{"Which USB bridge is used, and which baud rate does it really set?", step::bridge,
                  q::bridge_and_baud},
    open_question{"Which models send before they are asked, and what?", step::listening,
                  q::unasked_bytes},
    open_question{"With which number does the device identify itself?", step::identity, q::number},
    open_question{"Does a one-way lidar answer any query?", step::queries, q::one_way_answers},
    open_question{"Are the rate (D1), the direction (08) and low power (05) answered?",
                  step::queries, q::optional_queries},
    open_question{"What does the offset of zero (93) contain?", step::queries, q::zero_offset},
    open_question{"Which error codes does the health contain?", step::queries, q::health_codes},
    open_question{"Is there power-down protection (D9)?", step::protection, q::protection},
    open_question{"What is answered at the limits of the scan frequency?", step::frequency,
                  q::frequency_limits},
    open_question{"Which sample rate is behind each code?", step::sample_rate, q::rate_codes},
    open_question{"How long are the packets at each sample rate?", step::sample_rate,
                  q::packet_lengths},
    open_question{"Does the command 00 alone stop the scan?", step::start_and_stop, q::forced_stop},
    open_question{"How long does the motor spin up?", step::start_and_stop, q::spin_up},
    open_question{"Does an edge of DTR start the motor, or its level?", step::dtr, q::dtr_start},
    open_question{"Does DTR switch the motor, or the supply of the whole lidar?", step::dtr,
                  q::dtr_cut},
    open_question{"Do zero packets report the frequency, and with which offset?", step::stream,
                  q::reported_frequency},
    open_question{"Do all packets have the layout of the table?", step::stream, q::layout},
    open_question{"Are the two lower bits of a sample flags, intensity or range?",
                  step::sample_bits, q::lower_bits},
    open_question{"What do the flags 1, 2 and 3 mean?", step::sample_bits, q::flag_meaning},
    open_question{"Do the CT bytes contain information, and does a CRC byte follow?",
                  step::ct_information, q::ct_bytes},
    open_question{"Are there time packets?", step::time_packets, q::time_packets},
    open_question{"Where is zero, and is the offset of 93 already applied?", step::near_target,
                  q::zero_direction},
    open_question{"Is the unit of the range that of the table?", step::far_target, q::range_unit},
    open_question{"Do the settings outlive a loss of power?", step::unplug, q::kept_settings},
};

static_assert(questions.size() == acceptance_question_count);
static_assert(std::ranges::is_sorted(questions, {}, &open_question::which));

constexpr std::array<std::string_view, 3> state_names{"not_decided", "not_applicable", "answered"};

/// Why no step shows anything about it.
std::string reason_for(const open_question& of, std::span<const acceptance_result> results) {
  const auto done = std::ranges::find(results, of.step, &acceptance_result::step);
  return done == results.end() || done->text.empty() ? "The step was not done." : done->text;
}

}  // namespace

std::span<const open_question> open_questions() noexcept { return questions; }

std::string_view name_of(answer_state state) noexcept {
  return state_names.at(static_cast<std::size_t>(state));
}

std::vector<question_answer> answers_of(std::span<const acceptance_result> results) {
  std::vector<question_answer> all;
  for (const open_question& each : questions) {
    const question_answer* best = nullptr;
    for (const acceptance_result& result : results) {
      for (const question_answer& found : result.answers) {
        // A later step may know more.
        const bool is_better = best == nullptr || found.state >= best->state;
        if (found.question == each.which && is_better) best = &found;
      }
    }
    all.push_back(best != nullptr ? *best
                                  : question_answer{each.which, answer_state::not_decided,
                                                    reason_for(each, results)});
  }
  return all;
}

}  // namespace g4lidar
