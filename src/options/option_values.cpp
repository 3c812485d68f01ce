// SPDX-License-Identifier: MIT
// Texts and values of the rows of the table of options.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "g4lidar/core/request.hpp"
#include "option_access.hpp"

namespace g4lidar {
namespace {

/// Nobody writes a longer value.
constexpr std::size_t longest_text = 100;

std::optional<double> number_of(const parameter_value& from) {
  if (const auto* whole = std::get_if<std::int64_t>(&from)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&from)) return *number;
  const auto* const text = std::get_if<std::string>(&from);
  constexpr double most = std::numeric_limits<double>::max();
  const auto made = number_in(text != nullptr ? *text : "", -most, most);
  return made ? std::optional(*made) : std::nullopt;
}

/// "on" is true in the YAML of ROS, and "nan" and "inf" are numbers there.
parameter_value text_of(const parameter_value& from) {
  const auto* const text = std::get_if<std::string>(&from);
  if (text != nullptr && (*text == "true" || *text == "false"))
    return std::string(*text == "true" ? "on" : "off");
  const auto* const number = std::get_if<double>(&from);
  const bool has_word = from.index() == is_bool || (number != nullptr && !std::isfinite(*number));
  if (has_word) return word_of(from);
  return text != nullptr ? from : parameter_value();
}

/// The values of a setting of all models.
parameter_limits limits_of(const setting_info& of) {
  if (of.type == setting_type::decimal)
    return {"multiples of " + text_of_number(of.step / 100.0),
            {of.least / 100.0, of.most / 100.0, of.step / 100.0}};
  if (of.type == setting_type::word) return {list_of(of.values, &setting_value::word)};
  if (of.type != setting_type::whole) return {of.query ? "" : "known when it was set"};
  return {
      list_of(of.values, [](const setting_value& each) { return std::to_string(each.number); })};
}

}  // namespace

std::string word_of(const parameter_value& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "on" : "off";
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  if (const auto* number = std::get_if<double>(&value)) return text_of_number(*number);
  const auto* const text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : std::string();
}

text_result<parameter_value> value_for(const parameter& to, const parameter_value& value) {
  constexpr std::array<std::string_view, 5> types{"not set", "a bool", "an integer", "a double",
                                                  "a string"};
  parameter_value made = converted(value, to.type);
  if (made.index() != to.type)
    return tl::unexpected(std::string(to.name) + ": it is " + std::string(types.at(to.type)));
  const auto* const text = std::get_if<std::string>(&made);
  if (text != nullptr && text->size() > longest_text)
    return tl::unexpected(std::string(to.name) + ": the text is too long");
  return made;
}

std::string description_of(const parameter& of) {
  std::string made(of.text);
  if (!of.unit.empty()) made.append(", ").append(of.unit);
  if (!of.details.empty()) made.append("; ").append(of.details);
  if (of.unset.empty()) return made;
  return made.append(of.type == is_string ? "; empty: " : "; 0: ").append(of.unset);
}

std::string flag_of(const parameter& of) {
  std::string made(of.flag);
  if (!made.empty()) return made;
  made = "--";
  std::ranges::replace_copy(of.name, std::back_inserter(made), '_', '-');
  return made;
}

parameter_limits limits_of(const parameter& parameter, const model* model) {
  if (parameter.setting == nullptr) {
    if (parameter.name == "model") return {model_words(), {}};
    if (parameter.words.empty() || parameter.type != is_string) {
      const bool has_form = parameter.form.find_first_of(":,") != std::string_view::npos;
      return {has_form ? std::string(parameter.form) : "", parameter.range};
    }
    if (parameter.form.empty()) return {list_of(parameter.words), {}};
    return {"off, on, or limits: " + list_of(parameter.words, [](std::string_view each) {
              return std::string(each) + "=N";
            })};
  }
  parameter_limits made = limits_of(*parameter.setting);
  if (model == nullptr) return made;
  if (!has_request(*model, parameter.setting->change)) {
    made = {"this model does not have it", {}};
    if (parameter.setting->change == request_kind::set_scan_frequency)
      made.constraints += "; its speed: " + speed_without_commands(*model);
  } else if (parameter.setting->type == setting_type::decimal) {
    made.range = {model->frequency.min_chz / 100.0, model->frequency.max_chz / 100.0,
                  made.range[2]};
  } else if (parameter.setting->type == setting_type::whole) {
    made.constraints = list_of(std::span(model->rates.entries).first(rate_count(*model)),
                               [](const auto& rate) { return std::to_string(rate.hz); });
  }
  return made;
}

parameter_value converted(const parameter_value& value, std::uint8_t type) {
  if (type == is_string) return text_of(value);
  if (value.index() == type) return value;
  if (type == is_bool) {
    const std::string word = word_of(text_of(value));
    if (word != "on" && word != "off") return {};
    return word == "on";
  }
  const auto number = number_of(value);
  if (!number) return {};
  if (type == is_double) return *number;
  constexpr double largest = 1e15;  // each whole number below is a double
  const bool is_whole = std::trunc(*number) == *number && std::abs(*number) < largest;
  if (type != is_integer || !is_whole) return {};
  return static_cast<std::int64_t>(*number);
}

parameter_value value_of(const answer& given) {
  const setting_info* const of = setting_of(given);
  const auto number = number_of(given);
  if (of == nullptr || !number) return {};
  if (of->type == setting_type::on_off) return *number == 2;
  if (of->type == setting_type::whole) return std::int64_t{*number};
  if (of->type == setting_type::decimal) return *number / 100.0;
  const setting_value* const word = find_value(given);
  return word == nullptr ? parameter_value() : std::string(word->word);
}

result<answer> answer_of(const setting_info& setting, const parameter_value& wanted,
                         const model* model) {
  return value_in(setting, word_of(wanted), model);
}

std::string set_option(lidar_options& into, const parameter& parameter,
                       const parameter_value& value) {
  const auto made = converted(value, parameter.type);
  const auto number = number_of(made);
  const bool has_range = parameter.range[0] < parameter.range[1] && parameter.type != is_string;
  if (has_range && !(number && parameter.range[0] <= *number && *number <= parameter.range[1]))
    return not_in_range(word_of(value), parameter.range[0], parameter.range[1]);
  if (parameter.access == nullptr || made.index() != parameter.type)
    return in_quotes(word_of(value)) + " is no value of " + std::string(parameter.name);
  return parameter.access->set(into, made);
}

}  // namespace g4lidar
