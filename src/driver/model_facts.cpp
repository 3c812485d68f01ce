// SPDX-License-Identifier: MIT
// What the table states about a model, as text.
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/number_text.hpp"
#include "error_context.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/options/option_table.hpp"

namespace g4lidar {
namespace {

/// "4, 6": those of a pair that are not 0.
template <class Number>
std::string both(const std::array<Number, 2>& of) {
  return std::to_string(of[0]) + (of[1] != 0 ? ", " + std::to_string(of[1]) : "");
}

std::string sample_rates_of(const model& model) {
  std::string text;
  for (std::uint8_t code = 0; code < rate_count(model); ++code) {
    text += (code == 0 ? "" : ", ") + std::to_string(rate_hz_of_code(model, code));
  }
  if (model.rates.least_seen_hz == 0) return text;
  return text + " (" + std::to_string(model.rates.least_seen_hz) + " to " +
         std::to_string(model.rates.most_seen_hz) + " seen)";
}

std::string frequencies_of(const model& model) {
  const auto& [min_chz, max_chz, reply, ct, pin] = model.frequency;
  if (max_chz == 0) return "pin " + std::string(pin);
  return text_of_number(min_chz / 100.0) + " to " + text_of_number(max_chz / 100.0);
}

std::string samples_of(const model& model) {
  const sample_layout layout = model.samples.layout;
  std::string text = std::to_string(sample_size(layout)) + " bytes";
  if (const int bits = intensity_bits(layout); bits != 0)
    text += ", " + std::to_string(bits) + " bits";
  return text + (has_sample_flags(layout) ? ", flags" : "");
}

std::string commands_of(const model& model) {
  using enum request_kind;
  constexpr std::array<std::pair<request_kind, std::string_view>, 7> all{
      {{device_info, "information, health, restart"},
       {set_sample_rate, "sample_rate"},
       {set_scan_frequency, "frequency"},
       {set_direction, "direction, constant, idle"},
       {set_protection, "protection"},
       {zero_angle, "zero angle"},
       {request_kind::pitch, "pitch"}}};
  std::string text;
  for (const auto& [kind, name] : all) {
    if (!has_request(model, kind)) continue;
    text.append(text.empty() ? "" : ", ").append(name);
    if (kind == set_protection && model.protection == presence::unknown) text += " (not known)";
  }
  return text.empty() ? "none" : text;
}

}  // namespace

std::vector<model_fact> facts_of(const model& model) {
  const auto metres = [](std::uint16_t mm) { return text_of_number(mm / 1000.0); };
  return {{"word", std::string(model.word)},
          {"number", both(model.ids)},
          {"baud", both(model.bauds)},
          {"samples per second", sample_rates_of(model)},
          {"frequency in Hz", frequencies_of(model)},
          {"range in m", metres(model.range.min_mm) + " to " + metres(model.range.max_mm)},
          {"sample", samples_of(model)},
          {"0 points", model.turn_deg == 0 ? "ahead" : "back"},
          {"commands", commands_of(model)}};
}

std::vector<model_fact> facts_of(const recognition& what) {
  std::vector<model_fact> all;
  if (what.model == nullptr) return all;
  all = {{"model", std::string(what.model->word)},
         {"candidates", model_words(what.candidates)},
         {"known_by", std::string(name_of(what.by))}};
  if (what.number != 0) all.push_back({"number", std::to_string(what.number)});
  if (what.baud != 0) all.push_back({"baud", std::to_string(what.baud)});
  std::string contradictions = contradictions_of(what);
  if (!contradictions.empty()) all.push_back({"contradictions", std::move(contradictions)});
  return all;
}

}  // namespace g4lidar
