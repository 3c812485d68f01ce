// SPDX-License-Identifier: MIT
#include "g4lidar/diagnostics/diagnosis.hpp"

#include <array>
#include <string>
#include <utility>

namespace g4lidar {
namespace {

constexpr std::string_view program_name = "g4lidar: ";

diagnostic_level level_of(stage_verdict how) noexcept {
  switch (how) {
    case stage_verdict::warn:
      return diagnostic_level::warn;
    case stage_verdict::fail:
      return diagnostic_level::error;
    default:
      return diagnostic_level::ok;
  }
}

}  // namespace

diagnostic_status status_of(const stage_report& stage, std::string_view hardware_id) {
  diagnostic_status made{.level = level_of(stage.outcome),
                         .name = std::string(program_name).append(name_of(stage.stage)),
                         .hardware_id = std::string(hardware_id)};
  for (const diagnosis what : stage.diagnoses) {
    const diagnosis_info info = stage.explain(what);
    if (!made.message.empty()) made.message.append(" ");
    made.message.append(info.cause).append(" ").append(info.advice);
    made.values.emplace_back("diagnosis", info.name);
  }
  if (!stage.remark.empty()) {
    made.message.append(made.message.empty() ? "" : " ").append(stage.remark);
  }
  if (made.message.empty()) made.message = name_of(stage.outcome);
  for (const evidence& each : stage.measurements) made.values.emplace_back(each.name, each.text());
  return made;
}

diagnostic_status status_of(const reader_status& now, std::string_view why) {
  const bool is_bad = now.state == reader_state::opening || now.state == reader_state::lost ||
                      (now.state == reader_state::ended && !why.empty());
  diagnostic_status made{.level = is_bad ? diagnostic_level::error : diagnostic_level::ok,
                         .name = std::string(program_name).append("state"),
                         .message = std::string(name_of(now.state)),
                         .values = {{"device", now.name}}};
  if (now.information) made.hardware_id = now.information->serial_number();
  if (is_bad && !why.empty()) made.message.append(": ").append(why);
  for (const auto& [name, text] : now.recognised) {
    made.values.emplace_back(name, text);
    if (is_bad || name != "contradictions") continue;
    made.level = diagnostic_level::warn;
    made.message.append(". ").append(text);
  }
  return made;
}

diagnostic_status status_of(const lidar_counts& counts, std::string_view hardware_id) {
  diagnostic_status made{.name = std::string(program_name).append("counts"),
                         .message = "ok",
                         .hardware_id = std::string(hardware_id)};
  const stream_counts& stream = counts.stream;
  const std::array<std::pair<const char*, std::uint64_t>, 19> all{{
      {"bytes", counts.bytes},
      {"packets", stream.packets},
      {"responses", stream.responses},
      {"points", stream.points},
      {"suspect_packets", stream.suspect},
      {"skipped_noise_bytes", stream.skipped(skip_reason::noise)},
      {"skipped_bad_header_bytes", stream.skipped(skip_reason::bad_header)},
      {"skipped_bad_checksum_bytes", stream.skipped(skip_reason::bad_checksum)},
      {"skipped_truncated_bytes", stream.skipped(skip_reason::truncated)},
      {"time_packets", stream.time_packets},
      {"empty_packets", stream.empty_packets},
      {"crc_matches", stream.crc_matches},
      {"crc_mismatches", stream.crc_mismatches},
      {"samples_lost", counts.samples_lost},
      {"scans", counts.scans},
      {"partial_scans", counts.partial_scans},
      {"scans_missed", counts.scans_missed},
      {"command_retries", counts.command_retries},
      {"reconnects", counts.reconnects},
  }};
  for (const auto& [name, count] : all) made.values.emplace_back(name, std::to_string(count));
  return made;
}

std::vector<diagnostic_status> statuses_of(std::span<const stage_report> stages,
                                           const lidar_counts& counts,
                                           std::string_view hardware_id) {
  std::vector<diagnostic_status> all;
  all.reserve(stages.size() + 1);
  for (const stage_report& each : stages) all.push_back(status_of(each, hardware_id));
  all.push_back(status_of(counts, hardware_id));
  return all;
}

}  // namespace g4lidar
