// SPDX-License-Identifier: MIT
#include "g4lidar/transport/recognition.hpp"

#include <algorithm>
#include <array>

#include "core/number_text.hpp"
#include "discovery/fitting_models.hpp"
#include "g4lidar/core/model_choice.hpp"
#include "g4lidar/lidar_options.hpp"
#include "survey/change_signs.hpp"

namespace g4lidar {
namespace {

constexpr std::string_view please =
    " Please report it, with the file that g4-dump doctor --report writes.";

std::string number_text(std::uint8_t number, const recognition& recognition) {
  const model& read_as = *recognition.model;
  std::string text = "The lidar reports the number " + std::to_string(number);
  const auto with_number = [number](const model& row) { return row.has_number(number); };
  const auto* const owner = std::ranges::find_if(models, with_number);
  if (owner == models.end()) {
    text += ", which no known model has.";
  } else if (std::ranges::count_if(models, with_number) > 1) {
    text += ", that of other models.";
  } else {
    text.append(", that of ").append(article_of(*owner)).append(" ").append(owner->name);
    text += ".";
  }
  text.append(" It is read as ").append(article_of(read_as)).append(" ").append(read_as.name);
  if (recognition.candidates.size() > 1 && recognition.by == known_by::samples)
    text += ", and its packets may be those of " + model_words(recognition.candidates.subspan(1));
  if (recognition.by == known_by::nothing) text += " until its packets show more";
  text += ": compare the label of the lidar.";
  return owner == models.end() ? text.append(please) : text;
}

}  // namespace

std::string_view name_of(known_by what) noexcept {
  constexpr std::array<std::string_view, 5> names{"nothing", "user", "recording", "number",
                                                  "samples"};
  const auto at = static_cast<std::size_t>(what);
  return at < names.size() ? names[at] : names[0];
}

std::string contradictions_of(const recognition& what) {
  if (what.model == nullptr) return {};
  std::string all;
  const auto add = [&all](const std::string& sentence) {
    if (!all.empty()) all += " ";
    all += sentence;
  };
  if (what.number != 0 && !what.model->has_number(what.number)) add(number_text(what.number, what));
  const std::string one = std::string(article_of(*what.model)).append(" ").append(what.model->name);
  const bool may_change =
      what.by == known_by::number && !what.has_shown_samples && !what.was_stopped;
  if (what.baud != 0 && !may_change && !has_rate(*what.model, what.baud)) {
    const auto rates =
        list_of(rates_of(*what.model), [](auto baud) { return std::to_string(baud); });
    add("The line runs at " + std::to_string(what.baud) + " baud, " + one + " usually at " + rates +
        ".");
  }
  if (what.is_silent) {
    add("The lidar sends packets as of " + one + ", and answers no command: it can be read only. " +
        "Maybe its receiving wire is not connected, it is a one-way model, or a COIN-D4 (LDS-03).");
  }
  if (what.speaks_telnet) add(std::string(words_for(stream_change::telnet)));
  return all;
}

}  // namespace g4lidar
