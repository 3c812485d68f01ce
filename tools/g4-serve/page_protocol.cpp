// SPDX-License-Identifier: MIT
#include "page_protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "cli/logger.hpp"
#include "cli/setting_words.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/options/option_table.hpp"
#include "g4lidar/version.hpp"

namespace g4_tool {
namespace {

using json = nlohmann::ordered_json;

/// Texts for the page, which has no command line and reconnects automatically.
std::string in_page_words(std::string_view text) {
  constexpr tool_word unplugged{
      "Unless the program closed it, the lidar was unplugged: plug it in and open it again.",
      "The lidar was unplugged: plug it in. Then the scans continue by themselves."};
  return text == unplugged.library ? std::string(unplugged.tool) : in_tool_words(text);
}

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

json json_of(const std::vector<model_fact>& recognised) {
  json made;
  for (const auto& [name, text] : recognised) made[std::string(name)] = text;
  return made;
}

json json_of(const page_recording& recording) {
  const auto name_or_null = [](const std::string& name) {
    return name.empty() ? json(nullptr) : json(name);
  };
  return {{"file", name_or_null(recording.file)},
          {"last", name_or_null(recording.last)},
          {"why", recording.why},
          {"bytes", recording.bytes},
          {"seconds", recording.seconds}};
}

json json_of(const lidar_counts& counts) {
  return {{"bytes", counts.bytes},
          {"packets", counts.stream.packets},
          {"points", counts.stream.points},
          {"suspect", counts.stream.suspect},
          {"skipped_bytes", counts.stream.skipped_bytes()},
          {"samples_lost", counts.samples_lost},
          {"crc_mismatches", counts.stream.crc_mismatches},
          {"scans", counts.scans},
          {"scans_missed", counts.scans_missed},
          {"partial_scans", counts.partial_scans},
          {"command_retries", counts.command_retries},
          {"reconnects", counts.reconnects}};
}

json json_of(const evidence& measured) {
  return std::visit([](const auto& held) { return json(held); }, measured.value);
}

json json_of(const stage_report& stage, const std::string& lidar) {
  json made{{"stage", name_of(stage.stage)}, {"verdict", name_of(stage.outcome)}};
  if (!lidar.empty()) made["lidar"] = lidar;
  json& diagnoses = made["diagnoses"] = json::array();
  for (const diagnosis what : stage.diagnoses) {
    const diagnosis_info info = stage.explain(what);
    diagnoses.push_back({{"name", info.name},
                         {"cause", in_tool_words(info.cause)},
                         {"advice", in_page_words(info.advice)}});
  }
  json& all = made["evidence"] = json::array();
  for (const evidence& each : stage.measurements) {
    all.push_back({{"name", each.name}, {"value", json_of(each)}, {"unit", each.unit()}});
  }
  if (!stage.remark.empty()) made["remark"] = stage.remark;
  return made;
}

/// A measurement of a stage, or null.
json measured(const std::vector<stage_report>& stages, diagnostic_stage where,
              std::string_view name) {
  for (const stage_report& stage : stages) {
    for (const evidence& each : stage.measurements) {
      if (stage.stage == where && each.name == name) return json_of(each);
    }
  }
  return nullptr;
}

/// A row of the table of settings, with the values and limits of a model: how the page asks for a value.
json json_of(const setting_info& row, const g4lidar::model& model) {
  json made{{"name", row.name}, {"text", row.text}, {"unit", row.unit}};
  if (row.change == request_kind::set_scan_frequency) {
    made["least"] = model.frequency.min_chz / 100.0;
    made["most"] = model.frequency.max_chz / 100.0;
    made["step"] = row.step / 100.0;
  } else if (row.change == request_kind::set_sample_rate) {
    for (const auto& rate : model.rates.entries) {
      if (rate.hz != 0) made["values"].push_back(std::to_string(rate.hz));
    }
  } else {
    for (const setting_value& each : row.values) made["values"].push_back(std::string(each.word));
  }
  return made;
}

/// The settings that a model has; none while it is not known.
json setting_rows(const g4lidar::model* model) {
  json rows = json::array();
  if (model == nullptr) return rows;
  for (const setting_info& each : all_settings()) {
    if (has_request(*model, each.change)) rows.push_back(json_of(each, *model));
  }
  return rows;
}

json device_of(const page_lidar& lidar) {
  json made = g4_tool::json_of(lidar.device);
  const g4lidar::model* const model = lidar.model;
  made["name"] = model == nullptr ? json(nullptr) : json(model->name);
  made["range_m"] = model == nullptr ? json(nullptr) : json(model->range.max_mm / 1000.0);
  made["has_intensity"] = model == nullptr ? json(nullptr) : json(has_intensity(*model));
  made["speed_by"] = model == nullptr ? json(nullptr) : json(speed_without_commands(*model));
  return made;
}

/// What belongs to one lidar in a hello.
json json_of(const page_lidar& lidar) {
  return {{"device", device_of(lidar)},
          {"settings", lidar.settings},
          {"setting_rows", setting_rows(lidar.model)}};
}

/// Adds what belongs to one of several lidars to a status: itself, its stages and its counts.
void add_lidar(json& status, const page_status& lidar) {
  status["lidars"].push_back({{"name", lidar.lidar},
                              {"state", name_of(lidar.state)},
                              {"why", lidar.why},
                              {"recognition", json_of(lidar.recognised)},
                              {"scan_rate_hz", or_null(lidar.scan_rate_hz)},
                              {"sample_rate_hz", or_null(lidar.sample_rate_hz)},
                              {"frequency_hz", or_null(lidar.frequency_hz)},
                              {"loss", lidar.loss}});
  for (const stage_report& stage : lidar.stages) {
    status["stages"].push_back(json_of(stage, lidar.lidar));
  }
  const json counts = json_of(lidar.counts);
  for (auto& [name, count] : status["counts"].items()) {
    count = count.get<std::uint64_t>() + counts.at(name).get<std::uint64_t>();
  }
  status["checksum_errors"] = status["checksum_errors"].get<std::uint64_t>() +
                              lidar.counts.stream.skipped(skip_reason::bad_checksum);
}

/// The recording of one of several lidars, with those of the others.
void add(const page_recording& one, std::optional<page_recording>& all) {
  if (!all) {
    all = one;
    return;
  }
  const auto join = [](std::string& text, const std::string& more) {
    if (!more.empty()) text += (text.empty() ? "" : ", ") + more;
  };
  join(all->file, one.file);
  join(all->last, one.last);
  join(all->why, one.why);
  all->bytes += one.bytes;
  all->seconds = std::max(all->seconds, one.seconds);
}

bool is_only_one(const std::vector<page_lidar>& lidars) {
  return lidars.size() == 1 && lidars.front().name.empty();
}

json verdict_of(const std::vector<stage_report>& stages, diagnostic_stage where) {
  const auto stage = std::ranges::find(stages, where, &stage_report::stage);
  return stage == stages.end() ? json(nullptr) : json(name_of(stage->outcome));
}

}  // namespace

std::string hello_text(const page_hello& hello) {
  json made{
      {"op", "hello"},
      {"version", fmt::format("{}.{}.{}", G4LIDAR_VERSION_MAJOR, G4LIDAR_VERSION_MINOR,
                              G4LIDAR_VERSION_PATCH)},
      {"source", hello.source},
      {"frame", "robot"},
      {"allow_set", hello.allows_set},
      {"allow_record", hello.allows_record},
      {"recording", hello.recording_s ? json{{"length_s", *hello.recording_s}} : json(nullptr)}};
  if (is_only_one(hello.lidars)) {
    made.update(json_of(hello.lidars.front()));
    return json_line(made);
  }
  for (const page_lidar& each : hello.lidars) {
    json lidar{{"name", each.name}};
    lidar.update(json_of(each));
    made["lidars"].push_back(std::move(lidar));
  }
  return json_line(made);
}

std::string settings_text(const std::vector<page_lidar>& lidars) {
  json made{{"op", "settings"}};
  if (is_only_one(lidars)) {
    made["settings"] = lidars.front().settings;
  } else {
    for (const page_lidar& each : lidars) made["lidars"][each.name] = each.settings;
  }
  return json_line(made);
}

std::string event_text(std::string_view what, double time_s, std::string_view lidar) {
  json made{{"op", "event"}, {"what", what}, {"time", time_s}};
  if (!lidar.empty()) made["lidar"] = lidar;
  return json_line(made);
}

std::string error_text(std::string_view op, std::string_view message) {
  return json_line({{"op", "error"}, {"of", op}, {"message", message}});
}

page_status merged_status(std::vector<page_status> lidars) {
  page_status made;
  std::size_t running = 0;
  for (const page_status& each : lidars) {
    if (each.state == reader_state::running && running++ == 0) {
      made.scan_rate_hz = each.scan_rate_hz;
      made.frequency_hz = each.frequency_hz;
    }
    if (each.sample_rate_hz) {
      made.sample_rate_hz = made.sample_rate_hz.value_or(0) + *each.sample_rate_hz;
    }
    made.loss = std::max(made.loss, each.loss);
    if (!each.why.empty()) made.why += (made.why.empty() ? "" : " ") + each.lidar + ": " + each.why;
    if (each.recording) add(*each.recording, made.recording);
  }
  made.state = running > 0 || lidars.empty() ? reader_state::running : lidars.front().state;
  made.lidars = std::move(lidars);
  return made;
}

std::string status_text(const page_status& status) {
  json made{
      {"op", "status"},
      {"state", name_of(status.state)},
      {"why", status.why},
      {"recognition", json_of(status.recognised)},
      {"scan_rate_hz", or_null(status.scan_rate_hz)},
      {"sample_rate_hz", or_null(status.sample_rate_hz)},
      {"frequency_hz", or_null(status.frequency_hz)},
      {"loss", status.loss},
      {"checksum_errors", status.counts.stream.skipped(skip_reason::bad_checksum)},
      {"counts", json_of(status.counts)},
      {"usb_latency_ms", measured(status.stages, diagnostic_stage::usb_latency, "held_back_ms")},
      {"health", verdict_of(status.stages, diagnostic_stage::health)},
      {"stages", json::array()}};
  for (const stage_report& stage : status.stages) made["stages"].push_back(json_of(stage, ""));
  for (const page_status& each : status.lidars) add_lidar(made, each);
  if (status.playback) {
    made["position_s"] = static_cast<double>(status.playback->position_ns) * 1e-9;
    made["paused"] = status.playback->is_paused;
    made["speed"] = status.playback->speed;
  }
  if (status.recording) made["recording"] = json_of(*status.recording);
  return json_line(made);
}

}  // namespace g4_tool
