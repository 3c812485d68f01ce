// SPDX-License-Identifier: MIT
#include "picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>
#include <utility>

#include "cli/logger.hpp"

namespace g4_tool {
namespace {

using g4lidar::stage_report;
using g4lidar::stage_verdict;

constexpr int panel_columns = 26;
constexpr int label_columns = 10;
/// Smaller canvases have no panel.
constexpr int least_columns = 60;
constexpr int least_rows = 12;

std::string number_or_dash(double value, std::string_view unit, int decimals) {
  return value < 0 ? "-" : fmt::format("{:.{}f}{}", value, decimals, unit);
}

/// The worst stage, and the names of all diagnoses.
struct overall_state {
  stage_verdict outcome = stage_verdict::ok;
  std::vector<diagnosis_info> found{};
};
overall_state verdict_of(std::span<const stage_report> stages) {
  overall_state all;
  for (const stage_report& stage : stages) {
    if (!stage.diagnoses.empty()) all.outcome = std::max(all.outcome, stage.outcome);
    for (const diagnosis what : stage.diagnoses) all.found.push_back(stage.explain(what));
  }
  return all;
}

ink ink_of(stage_verdict how) noexcept {
  if (how == stage_verdict::fail) return ink::bad;
  return how == stage_verdict::warn ? ink::warn : ink::good;
}

std::string words_of(const overall_state& all, std::span<const stage_report> stages) {
  if (stages.empty()) return "-";
  if (all.found.empty()) return "ok";
  std::string names;
  for (const diagnosis_info& each : all.found) {
    names.append(names.empty() ? "" : " ").append(each.name);
  }
  return names;
}

std::string health_of(std::span<const stage_report> stages) {
  for (const stage_report& stage : stages) {
    if (stage.stage != g4lidar::diagnostic_stage::health) continue;
    for (const auto& each : stage.measurements) {
      if (each.name == "status") return each.text();
    }
  }
  return "-";
}

/// Writes lines into an area, from its top.
class column_of_words {
 public:
  column_of_words(canvas& canvas, const cell_area& area) : on_(canvas), in_(area) {}

  void line(std::string_view words, ink colour = ink::plain) {
    if (row_ < in_.rows) on_.write(in_.column, in_.row + row_, words, colour, in_);
    ++row_;
  }
  void fact(std::string_view label, const std::string& value, ink colour = ink::plain) {
    if (row_ < in_.rows) {
      on_.write(in_.column, in_.row + row_, label, ink::faint, in_);
      on_.write(in_.column + label_columns, in_.row + row_, value, colour, in_);
    }
    ++row_;
  }
  void paragraph(std::string_view words, ink colour = ink::plain) {
    std::istringstream lines(wrapped(words, 0, 0, static_cast<std::size_t>(in_.columns)));
    for (std::string each; std::getline(lines, each);) line(each, colour);
  }

 private:
  canvas& on_;
  cell_area in_;
  int row_ = 0;
};

void draw_panel(canvas& canvas, const cell_area& area, const view_facts& facts,
                const view_settings& settings) {
  column_of_words words(canvas, area);
  words.line(printable(facts.name), ink::title);
  const bool is_lost = facts.state == "lost" || facts.state == "ended";
  words.fact("state", settings.is_frozen ? facts.state + ", frozen" : facts.state,
             is_lost ? ink::bad : ink::plain);
  if (!facts.serial.empty()) words.fact("serial", facts.serial);
  words.fact("frequency", number_or_dash(facts.frequency_hz, " Hz", 2));
  words.fact("samples", number_or_dash(facts.sample_rate_hz, " /s", 0));
  words.fact("scans", number_or_dash(static_cast<double>(facts.scans), "", 0));
  if (const auto& found = facts.intensity)
    words.fact("intensity", fmt::format("{} to {}", found->first, found->second));
  words.fact("lost", number_or_dash(facts.lost_percent, " %", 2),
             facts.lost_percent > 0.2 ? ink::warn : ink::plain);
  words.fact("checksum", number_or_dash(static_cast<double>(facts.checksum_errors), "", 0));
  words.fact("health", health_of(facts.stages));
  const char* const frame = settings.radar.frame == g4lidar::frame::robot ? "robot" : "vendor";
  words.fact("frame", settings.radar.is_map ? "map" : frame);
  words.fact("range",
             fmt::format("{:g} m{}", settings.radar.range_m, settings.is_zoomed ? "" : ", auto"));
  if (facts.length_s >= 0) {
    words.fact("position",
               fmt::format("{:.1f} of {:.1f} s", std::max(facts.position_s, 0.0), facts.length_s));
  }
  words.fact("event", facts.event.empty() ? "-" : facts.event);
  const overall_state all = verdict_of(facts.stages);
  words.line("");
  words.line("doctor", ink::faint);
  words.paragraph(words_of(all, facts.stages), ink_of(all.outcome));
  if (!facts.why.empty()) words.paragraph(printable(facts.why), ink::warn);
  for (const diagnosis_info& each : all.found) {
    words.paragraph(each.cause);
    words.paragraph(in_tool_words(each.advice), ink::faint);
  }
}

/// The most important facts in one line.
std::string summary_of(const view_facts& facts, const view_settings& settings) {
  const overall_state all = verdict_of(facts.stages);
  return fmt::format("{} {} {} lost {} doctor {}", settings.is_frozen ? "frozen" : facts.state,
                     number_or_dash(facts.frequency_hz, " Hz", 2),
                     number_or_dash(facts.sample_rate_hz, "/s", 0),
                     number_or_dash(facts.lost_percent, "%", 2), words_of(all, facts.stages));
}

constexpr std::array<std::pair<std::string_view, std::string_view>, 9> keys{
    {{"+ -", "nearer, farther"},
     {"0", "the range follows the returns"},
     {"p", "freeze the picture, or go on"},
     {"f", "frame: robot, vendor, map"},
     {"t", "trails: off, 2 s, 10 s"},
     {"g", "rings on, off"},
     {"space", "a recording: pause, play"},
     {"h ?", "this help, on and off"},
     {"q", "quit"}}};

void draw_help(canvas& canvas, const cell_area& area) {
  column_of_words words(canvas, area);
  words.line("keys", ink::title);
  for (const auto& [key, meaning] : keys) words.line(fmt::format("{:<6}{}", key, meaning));
}

}  // namespace

void draw_view(canvas& canvas, std::span<const g4lidar::point> points, const view_facts& facts,
               const view_settings& settings) {
  const bool has_panel = canvas.columns() >= least_columns && canvas.rows() >= least_rows;
  if (settings.shows_help && !has_panel)
    return draw_help(canvas, {0, 0, canvas.columns(), canvas.rows()});
  const overall_state all = verdict_of(facts.stages);
  const int beside = has_panel ? panel_columns + 1 : 0;
  const cell_area radar{0, 0, canvas.columns() - beside, canvas.rows() - (has_panel ? 0 : 1)};
  draw_radar(canvas, radar, points, settings.radar);
  if (!has_panel) {
    const std::string words = summary_of(facts, settings);
    return canvas.write(0, canvas.rows() - 1, words, ink_of(all.outcome));
  }
  const cell_area panel{canvas.columns() - panel_columns, 0, panel_columns, canvas.rows() - 1};
  if (settings.shows_help) {
    const int wide = std::min(canvas.columns(), 40);
    draw_help(canvas, {canvas.columns() - wide, 0, wide, canvas.rows() - 1});
  } else {
    draw_panel(canvas, panel, facts, settings);
  }
  canvas.write(panel.column, canvas.rows() - 1, "+ - 0 p f g h help q quit", ink::faint);
}

}  // namespace g4_tool
