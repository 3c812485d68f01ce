// SPDX-License-Identifier: MIT
#include "page_protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "cli/logger.hpp"
#include "cli/settings.hpp"
#include "client_json.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/setting_table.hpp"
#include "g4lidar/version.hpp"

namespace g4_tool {
namespace {

using json = nlohmann::ordered_json;

template <class Unsigned>
void put_little(Unsigned value, std::vector<std::uint8_t>& out) {
  for (std::size_t i = 0; i < sizeof(value); ++i) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

/// Texts for the page, which has no command line and reconnects automatically.
std::string in_page_words(std::string_view text) {
  constexpr tool_word unplugged{
      "Unless the program closed it, the lidar was unplugged: plug it in and open it again.",
      "The lidar was unplugged: plug it in. Then the scans continue by themselves."};
  return text == unplugged.library ? std::string(unplugged.tool) : in_tool_words(text);
}

json or_null(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }

/// A value as a word of `g4-dump set`; empty if it is not one.
std::string word_of(const nlohmann::json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "on" : "off";
  if (value.is_number_integer()) return value.dump();
  if (value.is_number() && std::isfinite(value.get<double>())) {
    return fmt::format("{}", value.get<double>());
  }
  return {};
}

page_request parse_set(const nlohmann::json& object) {
  const auto name = object.find("name");
  const auto value = object.find("value");
  const std::string word = value == object.end() ? "" : word_of(*value);
  if (name == object.end() || !name->is_string() || word.empty()) {
    return bad_request{"set", "needs a name and a value"};
  }
  return set_request{name->get<std::string>(), word};
}

page_request parse_play(const nlohmann::json& object) {
  play_request made{{}, number_in(object, "speed"), number_in(object, "seek_s")};
  const auto paused = object.find("paused");
  if (paused != object.end() && paused->is_boolean()) made.paused = paused->get<bool>();
  const auto known = std::size_t{made.paused.has_value()} + std::size_t{made.speed.has_value()} +
                     std::size_t{made.seek_s.has_value()};
  if (known == 0 || known + 1 != object.size()) {
    return bad_request{"play", "needs paused, speed or seek_s, and nothing else"};
  }
  return made;
}

page_request parse_record(const nlohmann::json& object) {
  const auto on = object.find("on");
  if (on == object.end() || !on->is_boolean() || object.size() != 2) {
    return bad_request{"record", "needs on, and nothing else"};
  }
  return record_request{on->get<bool>()};
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

json json_of(const stage_report& stage) {
  json made{{"stage", name_of(stage.stage)}, {"verdict", name_of(stage.outcome)}};
  json& diagnoses = made["diagnoses"] = json::array();
  for (const diagnosis what : stage.diagnoses) {
    const diagnosis_info info = describe(what);
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

/// A row of the table of settings: how the page asks for a value.
json json_of(const setting_info& row) {
  json made{{"name", row.name}, {"text", row.text}, {"unit", row.unit}};
  if (row.values.empty()) {
    made["least"] = row.least / 100.0;
    made["most"] = row.most / 100.0;
    made["step"] = row.step / 100.0;
    return made;
  }
  for (const setting_value& each : row.values) {
    const bool is_number = row.type == setting_type::whole;
    made["values"].push_back(is_number ? std::to_string(each.number) : std::string(each.word));
  }
  return made;
}

json setting_rows() {
  json rows = json::array();
  for (const setting_info& each : all_settings()) rows.push_back(json_of(each));
  return rows;
}

json verdict_of(const std::vector<stage_report>& stages, diagnostic_stage where) {
  const auto stage = std::ranges::find(stages, where, &stage_report::stage);
  return stage == stages.end() ? json(nullptr) : json(name_of(stage->outcome));
}

}  // namespace

std::optional<page_request> parse_page_request(std::string_view text) {
  const auto object = request_in(text);
  if (!object) return std::nullopt;
  const std::string op = object->at("op").get<std::string>();
  if (op == "set") return parse_set(*object);
  if (op == "play") return parse_play(*object);
  if (op == "record") return parse_record(*object);
  return bad_request{op, "is not a request"};
}

std::string hello_text(const page_hello& hello) {
  return json_line(
      {{"op", "hello"},
       {"version", fmt::format("{}.{}.{}", G4LIDAR_VERSION_MAJOR, G4LIDAR_VERSION_MINOR,
                               G4LIDAR_VERSION_PATCH)},
       {"source", hello.source},
       {"frame", "robot"},
       {"device", json_of(hello.device)},
       {"allow_set", hello.allows_set},
       {"allow_record", hello.allows_record},
       {"settings", hello.settings},
       {"setting_rows", setting_rows()},
       {"recording", hello.recording_s ? json{{"length_s", *hello.recording_s}} : json(nullptr)}});
}

std::string settings_text(const json& settings) {
  return json_line({{"op", "settings"}, {"settings", settings}});
}

std::string event_text(std::string_view what, double time_s) {
  return json_line({{"op", "event"}, {"what", what}, {"time", time_s}});
}

std::string error_text(std::string_view of, std::string_view message) {
  return json_line({{"op", "error"}, {"of", of}, {"message", message}});
}

std::string status_text(const page_status& status) {
  json made{
      {"op", "status"},
      {"state", name_of(status.state)},
      {"why", status.why},
      {"scan_rate_hz", or_null(status.scan_rate_hz)},
      {"sample_rate_hz", or_null(status.sample_rate_hz)},
      {"frequency_hz", or_null(status.frequency_hz)},
      {"loss", status.loss},
      {"checksum_errors", status.counts.stream.skipped(skip_reason::bad_checksum)},
      {"counts", json_of(status.counts)},
      {"usb_latency_ms", measured(status.stages, diagnostic_stage::usb_latency, "held_back_ms")},
      {"health", verdict_of(status.stages, diagnostic_stage::health)},
      {"stages", json::array()}};
  for (const stage_report& stage : status.stages) made["stages"].push_back(json_of(stage));
  if (status.playback) {
    made["position_s"] = static_cast<double>(status.playback->position_ns) * 1e-9;
    made["paused"] = status.playback->is_paused;
    made["speed"] = status.playback->speed;
  }
  if (status.recording) made["recording"] = json_of(*status.recording);
  return json_line(made);
}

void put_page_scan(const page_scan& what, std::vector<std::uint8_t>& out) {
  constexpr unsigned has_place = 2;
  const scan& revolution = what.revolution;
  const std::size_t begin = out.size();
  out.push_back(0x10);
  out.push_back(
      static_cast<std::uint8_t>((revolution.is_whole() ? 1U : 0U) | (what.place ? has_place : 0U)));
  put_little(std::uint16_t{0}, out);
  put_little(revolution.revolution, out);
  put_little(std::bit_cast<std::uint64_t>(what.stamp_s), out);
  std::uint16_t count = 0;
  for (const point& p : revolution) {
    if (p.is_no_return() || count == UINT16_MAX) continue;
    const xy_point at = to_xy(p, frame::robot, revolution.model->turn_deg);
    put_little(std::bit_cast<std::uint32_t>(at.x_m), out);
    put_little(std::bit_cast<std::uint32_t>(what.is_upside_down ? -at.y_m : at.y_m), out);
    ++count;
  }
  out[begin + 2] = static_cast<std::uint8_t>(count);
  out[begin + 3] = static_cast<std::uint8_t>(count >> 8U);
  if (what.place) {
    put_little(what.place->map, out);
    for (const double value :
         {what.place->pose.x_m, what.place->pose.y_m, what.place->pose.yaw_rad})
      put_little(std::bit_cast<std::uint64_t>(value), out);
  }
}

}  // namespace g4_tool
