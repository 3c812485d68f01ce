// SPDX-License-Identifier: MIT
// The steps with a running scan: stream, sample bits, CT bytes, time packets.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "kit_rows.hpp"

namespace g4_tool::acceptance {
namespace {

using enum finding;

/// What the two lower bits of samples are.
enum class bit_use : std::uint8_t { unclear, unused, flags, intensity, range };

constexpr std::array<std::string_view, 5> bit_words{"not clear", "always 0", "flags", "intensity",
                                                    "range"};

/// Ranges have all values about equally often; flags have one much more often than the others.
bit_use use_by_values(const packet_survey& heard) {
  constexpr std::uint64_t fewest = 1'000;
  std::array<std::uint64_t, 4> values{};
  for (std::size_t zone = packet_survey::below_1_m; zone < packet_survey::zones; ++zone) {
    for (std::size_t value = 0; value < values.size(); ++value)
      values.at(value) += heard.bits.at(zone).at(value);
  }
  const std::uint64_t returns = values[0] + values[1] + values[2] + values[3];
  const auto& [none, first, second, third] = heard.bits[packet_survey::no_return];
  if (returns < fewest) return bit_use::unclear;
  if (returns == values[0] && first + second + third == 0) return bit_use::unused;
  if (*std::ranges::min_element(values) * 20 >= returns) return bit_use::range;
  return *std::ranges::max_element(values) * 5 >= returns * 4 ? bit_use::flags : bit_use::unclear;
}

/// Where the bits change, a byte of intensity below them overflows, and one beside flags goes on.
bit_use use_by_changes(const packet_survey& heard) {
  constexpr std::uint64_t fewest = 20;
  const std::uint64_t all = heard.smooth_changes + heard.overflows;
  if (all < fewest) return bit_use::unclear;
  if (heard.smooth_changes * 10 >= all * 9) return bit_use::flags;
  return heard.overflows * 10 >= all * 9 ? bit_use::intensity : bit_use::unclear;
}

/// By the table; `unclear` where it does not have it.
bit_use stated_use(sample_layout layout) noexcept {
  if (layout == sample_layout::quarter_mm) return bit_use::unclear;
  if (has_sample_flags(layout)) return bit_use::flags;
  return layout == sample_layout::intensity_10 ? bit_use::intensity : bit_use::range;
}

}  // namespace

void stream(tested_lidar& lidar, step_result& result) {
  lidar_link& link = *lidar.link;
  if (link.start() < 0) {
    result.add("packets", 0);
    result.add("sample_bytes", link.sample_bytes());
    link.stop();
    return;
  }
  static_cast<void>(link.survey(spun_up_ns));
  const std::uint64_t skipped_before = link.counts().skipped_bytes();
  lidar.surveyed = std::make_unique<packet_survey>(
      steady_survey(link, std::chrono::nanoseconds(lidar.options.stream_time).count()));
  const packet_survey& heard = *lidar.surveyed;
  link.stop();
  const std::uint64_t packets = heard.counts.packets;
  result.add("packets", packets);
  result.add("skipped_bytes", link.counts().skipped_bytes() - skipped_before);
  if (link.sample_bytes() != 0) result.add("sample_bytes", link.sample_bytes());
  if (packets == 0) return;
  const bool has_rates =
      heard.is_steady() || lidar.options.stream_time > std::chrono::nanoseconds(short_survey_ns);
  result.add("revolutions", heard.zero_packets);
  result.add("most_samples", heard.most_samples);
  if (has_rates) {
    result.add("damaged_percent", 100.0 * static_cast<double>(heard.bad_checksums) /
                                      static_cast<double>(packets + heard.bad_checksums));
    result.add("sample_rate_hz", heard.sample_rate_hz());
    result.add("frequency_hz", heard.frequency_hz());
  } else {
    result.find(observed, not_steady);
  }
  const auto add_range = [&](std::string name, std::optional<std::size_t> at) {
    const auto range_mm = at ? heard.directions.range_mm(*at) : std::nullopt;
    if (range_mm) result.add(std::move(name), *range_mm);
  };
  add_range("shortest_mm", heard.directions.nearest());
  add_range("longest_mm", heard.directions.farthest());
  const bool reports = heard.reported_hz() > 0.0;
  if (heard.zero_packets > 2) result.add("reports_frequency", reports);
  if (reports && has_rates) result.add("offset_hz", heard.frequency_hz() - heard.reported_hz());
  if (!reports) result.find(observed, "Zero packets do not report the frequency.");
}

void sample_bits(tested_lidar& lidar, step_result& result) {
  const packet_survey& heard = *lidar.surveyed;
  const sample_layout layout = lidar.row.samples.layout;
  constexpr std::array<std::string_view, packet_survey::zones> names{"no_return", "below_1_m",
                                                                     "below_2_m", "beyond"};
  for (std::size_t at = 0; at < names.size(); ++at)
    result.add(fmt::format("{}_bits", names.at(at)),
               fmt::format("{}", fmt::join(heard.bits.at(at), " ")));
  const bool has_byte = sample_size(layout) == 3;
  if (has_byte) {
    result.add("smooth_changes", heard.smooth_changes);
    result.add("overflows", heard.overflows);
  }
  const bit_use found = has_byte ? use_by_changes(heard) : use_by_values(heard);
  const bit_use stated = stated_use(layout);
  const std::string word(bit_words.at(static_cast<std::size_t>(found)));
  if (found != bit_use::unclear) result.add("lower_bits", word);
  const bool may_be = found == bit_use::unused && stated == bit_use::flags;  // no flag was set
  if (found == bit_use::unclear || stated == bit_use::unclear || may_be || found == stated) {
    const bool is_right = found == stated && found != bit_use::unclear;
    return result.find(is_right ? agrees : observed,
                       fmt::format("The two lower bits are {}.", word));
  }
  result.find(differs, fmt::format("lower_bits is {}, expected {}.", word,
                                   bit_words.at(static_cast<std::size_t>(stated))));
}

void ct_information(tested_lidar& lidar, step_result& result) {
  constexpr std::uint64_t packets_with_information = 14;
  constexpr std::uint64_t enough = 3;
  const packet_survey& heard = *lidar.surveyed;
  const auto& who = heard.information();
  const bool has_byte = heard.crc_fits + heard.crc_misfits >= enough;
  const bool has_crc = heard.crc_fits >= enough && heard.crc_fits > heard.crc_misfits;
  const bool is_long = heard.zero_packets > enough;
  result.add("crc_fits", heard.crc_fits);
  result.add("crc_does_not_fit", heard.crc_misfits);
  if (is_long) result.add("crc_byte", has_crc);
  result.find(observed, has_crc    ? "A CRC byte follows."
                        : has_byte ? "A byte follows that is not the CRC."
                                   : "No byte follows.");
  if (who) {
    result.add("number", who->id_low_bits);
    result.add("firmware", fmt::format("{}.{}", who->firmware_major, who->firmware_minor));
    result.add("hardware", who->hardware);
    result.add("faults", static_cast<std::uint8_t>(who->faults));
  }
  if (!who && has_crc && heard.counts.packets < packets_with_information * heard.zero_packets)
    return result.find(observed, "A revolution has too few packets for the information.");
  if (is_long) result.add("information", who.has_value());
}

void time_packets(tested_lidar& lidar, step_result& result) {
  constexpr auto long_enough = std::chrono::seconds(10);
  const std::uint64_t count = lidar.surveyed->counts.time_packets;
  const bool is_decided = count > 0 || lidar.options.stream_time >= long_enough;
  if (is_decided) result.add("time_packets", count);
  result.find(observed, count > 0    ? "It sends time packets."
                        : is_decided ? "It sends no time packets."
                                     : "There were none in less than 10 s.");
}

}  // namespace g4_tool::acceptance
