// SPDX-License-Identifier: MIT
// The steps with a running scan: stream, sample bits, CT bytes, time packets.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "acceptance_run.hpp"

namespace g4lidar {
namespace {

using enum acceptance_verdict;
using enum answer_state;
using q = acceptance_question;
using zone = stream_survey::zone;

/// What the two lower bits of samples are.
enum class bit_use : std::uint8_t { unclear, unused, flags, intensity, range };

constexpr std::array<std::string_view, 5> bit_words{
    "What the two lower bits are is not clear.", "The two lower bits are always 0.",
    "The two lower bits are flags.", "The two lower bits are intensity.",
    "The two lower bits are range."};

/// How many samples in the zones from `first` on have each value of the bits.
std::array<std::uint64_t, 4> bits_from(const stream_survey& heard, zone first) {
  std::array<std::uint64_t, 4> all{};
  for (std::size_t at = first; at < stream_survey::zones; ++at) {
    for (unsigned value = 0; value < all.size(); ++value) {
      all.at(value) += heard.bits(static_cast<zone>(at), value);
    }
  }
  return all;
}

/// Ranges have all values about equally often; flags have one much more often than the others.
bit_use use_by_values(const stream_survey& heard) {
  constexpr std::uint64_t fewest = 1'000;
  const auto values = bits_from(heard, zone::below_1_m);
  const std::uint64_t returns = values[0] + values[1] + values[2] + values[3];
  if (returns < fewest) return bit_use::unclear;
  if (returns == values[0] && bits_from(heard, zone::no_return)[0] == heard.samples()) {
    return bit_use::unused;
  }
  if (*std::ranges::min_element(values) * 20 >= returns) return bit_use::range;
  return *std::ranges::max_element(values) * 5 >= returns * 4 ? bit_use::flags : bit_use::unclear;
}

/// Where the bits change, a byte of intensity below them overflows, and one beside flags goes on.
bit_use use_by_changes(const stream_survey& heard) {
  constexpr std::uint64_t fewest = 20;
  const std::uint64_t all = heard.smooth_changes() + heard.overflows();
  if (all < fewest) return bit_use::unclear;
  if (heard.smooth_changes() * 10 >= all * 9) return bit_use::flags;
  return heard.overflows() * 10 >= all * 9 ? bit_use::intensity : bit_use::unclear;
}

/// By the table; `unclear` where it does not have it.
bit_use stated_use(sample_layout layout) noexcept {
  if (layout == sample_layout::quarter_mm) return bit_use::unclear;
  if (has_sample_flags(layout)) return bit_use::flags;
  return layout == sample_layout::intensity_10 ? bit_use::intensity : bit_use::range;
}

/// "1: 4 % without a return, 0 % below 1 m, 0 % below 2 m, 0 % beyond; ..."
std::string flags_by_range(const stream_survey& heard) {
  constexpr std::array<std::string_view, stream_survey::zones> names{
      " % without a return", " % below 1 m", " % below 2 m", " % beyond"};
  std::string text;
  const auto values = bits_from(heard, zone::no_return);
  for (unsigned value = 1; value < 4; ++value) {
    if (values.at(value) == 0) continue;
    text += (text.empty() ? "" : "; ") + std::to_string(value) + ":";
    for (std::size_t at = 0; at < names.size(); ++at) {
      std::uint64_t all = 0;
      for (unsigned each = 0; each < 4; ++each) all += heard.bits(static_cast<zone>(at), each);
      const std::uint64_t count = heard.bits(static_cast<zone>(at), value);
      text += (at == 0 ? " " : ", ") + std::to_string(all == 0 ? 0 : (100 * count + all / 2) / all);
      text += names.at(at);
    }
  }
  return text;
}

}  // namespace

void acceptance_run::stream(acceptance_result& into) {
  if (link_->start() < 0) {
    link_->stop();
    return into.add_finding(differs, "No packet came.");
  }
  static_cast<void>(link_->survey(spun_up_ns));
  const std::uint64_t skipped_before = link_->monitor().counts().skipped_bytes();
  surveyed_ = std::make_unique<stream_survey>(
      link_->steady_survey(std::chrono::nanoseconds(options_.stream_time).count()));
  const stream_survey& heard = *surveyed_;
  link_->stop();
  into.add("packets", heard.counts().packets);
  into.add("bad_checksums", heard.bad_checksums());
  into.add("skipped_bytes", link_->monitor().counts().skipped_bytes() - skipped_before);
  into.add("revolutions", heard.zero_packets());
  into.add("most_samples", heard.most_samples());
  into.add("sample_rate_hz", heard.sample_rate_hz());
  into.add("frequency_hz", heard.frequency_hz());
  into.add("reported_hz", heard.reported_hz());
  into.add("sample_bytes", link_->monitor().layout().sample_bytes());
  if (heard.counts().packets == 0)
    return into.add_finding(differs, "No packet of the model's layout came.");
  const std::uint64_t all = heard.counts().packets + heard.bad_checksums();
  constexpr std::uint64_t hundred = 100;
  const bool is_clean = heard.bad_checksums() * hundred <= all;
  into.add_answer(q::layout, answered,
                  std::to_string(heard.counts().packets) + " of " + std::to_string(all) +
                      " packets are valid by the table.");
  into.add_finding(is_clean ? agrees : differs, is_clean
                                                    ? "The packets have the layout of the model."
                                                    : "Many packets have a wrong checksum.");
  const bool is_long = heard.zero_packets() > 2;
  if (!which_->rates.is_settable) {
    into.add_answer(q::packet_lengths, is_long ? answered : not_decided,
                    "At most " + std::to_string(heard.most_samples()) + " samples, at " +
                        std::to_string(std::lround(heard.sample_rate_hz())) + " Hz.");
  }
  if (heard.most_samples() > which_->samples.max_samples) {
    into.add_finding(differs, "Packets are longer than in the table.");
  }
  const expected_rate rate = expected_rate_of(*which_, first_rate_hz(*which_));
  const bool is_known_rate =
      std::ranges::any_of(which_->rates.entries, [&](const sample_rate_entry& each) {
        return each.hz != 0 &&
               std::abs(heard.sample_rate_hz() / each.hz - 1.0) <= std::max(rate.tolerance, 0.1);
      });
  if (!is_known_rate) into.add_finding(differs, "The sample rate is none of the table.");
  if (heard.reported_hz() <= 0.0) {
    into.add_finding(observed, "Zero packets do not report the frequency.");
    into.add_answer(q::reported_frequency, is_long ? answered : not_decided, "They do not.");
  } else {
    const double offset_hz = heard.frequency_hz() - heard.reported_hz();
    into.add("offset_hz", offset_hz);
    into.add_answer(q::reported_frequency, is_long ? answered : not_decided,
                    "They do; the measured one is higher by " +
                        std::to_string(std::lround(offset_hz * 10.0)) + " in 0.1 Hz.");
    constexpr double tolerance_hz = 0.3;
    const double stated_hz = which_->frequency.ct_offset_dhz / 10.0;
    if (std::abs(offset_hz - stated_hz) > tolerance_hz) {
      into.add_finding(differs, "The frequency in zero packets has another offset.");
    }
  }
}

void acceptance_run::sample_bits(acceptance_result& into) const {
  const stream_survey& heard = *surveyed_;
  constexpr std::array<std::string_view, stream_survey::zones> names{"no_return", "below_1_m",
                                                                     "below_2_m", "beyond"};
  for (std::size_t zone = 0; zone < names.size(); ++zone) {
    for (unsigned value = 0; value < 4; ++value) {
      const std::uint64_t count = heard.bits(static_cast<stream_survey::zone>(zone), value);
      into.add(std::string(names.at(zone)) + "_bits_" + std::to_string(value), count);
    }
  }
  const bool has_byte = sample_size(which_->samples.layout) == 3;
  if (has_byte) {
    into.add("smooth_changes", heard.smooth_changes());
    into.add("overflows", heard.overflows());
  }
  const bit_use found = has_byte ? use_by_changes(heard) : use_by_values(heard);
  const bit_use stated = stated_use(which_->samples.layout);
  const std::string_view words = bit_words.at(static_cast<std::size_t>(found));
  const bool is_open = found == bit_use::unclear || stated == bit_use::unclear;
  const bool may_be = found == bit_use::unused && stated == bit_use::flags;  // no flag was set
  into.add_finding(is_open || may_be ? observed : found == stated ? agrees : differs, words);
  into.add_answer(q::lower_bits, found == bit_use::unclear ? not_decided : answered, words);
  if (found == bit_use::flags) {
    into.add_answer(q::flag_meaning, not_decided,
                    "The shares by range do not show the cause: " + flags_by_range(heard) + ".");
  } else {
    const bool is_known = found != bit_use::unclear && !may_be;
    into.add_answer(q::flag_meaning, is_known ? not_applicable : not_decided, words);
  }
}

void acceptance_run::ct_information(acceptance_result& into) const {
  const stream_survey& heard = *surveyed_;
  into.add("crc_fits", heard.crc_fits());
  into.add("crc_does_not_fit", heard.crc_misfits());
  into.add("packets_with_ct", heard.informing_packets());
  const bool has_crc = heard.crc_fits() >= 3 && heard.crc_fits() > heard.crc_misfits();
  const std::string crc = has_crc ? "A CRC byte follows." : "There is no CRC byte.";
  const bool is_long = heard.zero_packets() > 3;
  into.add_finding(observed,
                   has_crc ? "A CRC byte follows each revolution." : "There is no CRC byte.");
  const auto& who = heard.information();
  if (who) {
    into.add("id_low_bits", who->id_low_bits);
    into.add("firmware",
             std::to_string(who->firmware_major) + "." + std::to_string(who->firmware_minor));
    into.add("hardware", who->hardware);
    into.add("faults", static_cast<std::uint8_t>(who->faults));
    into.add_answer(
        q::number, answered,
        "In its CT bytes, of which there are four bits: " + std::to_string(who->id_low_bits) + ".");
  }
  constexpr std::uint64_t packets_with_information = 14;
  if (!who && has_crc && heard.counts().packets < packets_with_information * heard.zero_packets()) {
    into.add_answer(q::ct_bytes, not_decided,
                    crc + " A revolution has too few packets for the information.");
    return into.add_finding(observed, "A revolution has too few packets for the information.");
  }
  into.add_answer(q::ct_bytes, is_long ? answered : not_decided,
                  (who ? "They contain information. " : "They contain none. ") + crc);
  const presence seen = who ? presence::yes : presence::no;
  const bool is_open = which_->ct_information == presence::unknown;
  into.add_finding(
      is_open                          ? observed
      : seen == which_->ct_information ? agrees
                                       : differs,
      who ? "The CT bytes contain information." : "The CT bytes contain no information.");
}

void acceptance_run::time_packets(acceptance_result& into) const {
  constexpr auto long_enough = std::chrono::seconds(10);
  const bool has_any = surveyed_->counts().time_packets > 0;
  const bool is_decided = has_any || options_.stream_time >= long_enough;
  into.add("time_packets", surveyed_->counts().time_packets);
  into.add_answer(q::time_packets, is_decided ? answered : not_decided,
                  has_any      ? "There are."
                  : is_decided ? "There are none."
                               : "There were none in less than 10 s.");
  into.add_finding(observed, has_any ? "It sends time packets." : "It sends no time packets.");
}

}  // namespace g4lidar
