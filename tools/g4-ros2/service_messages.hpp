// SPDX-License-Identifier: MIT
// The services of the node on the wire: their types, and C++ values in their C structures.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <services.h>
#include "dds/service.hpp"
#include "g4lidar/lidar_parameters.hpp"

namespace g4_tool {

extern const dds::service_type get_type;
extern const dds::service_type get_types_type;
extern const dds::service_type set_type;
extern const dds::service_type set_atomically_type;
extern const dds::service_type list_type;
extern const dds::service_type describe_type;
extern const dds::service_type trigger_type;

/// A reply and what it refers to.
template <class Message, class Part = char*>
struct reply_with {
  Message message{};
  std::vector<Part> parts;
  std::deque<std::string> texts;

  char* text(std::string_view words) { return texts.emplace_back(words).data(); }
};

/// `parts` become the contents of a sequence, which does not own them.
template <class Sequence, class Part>
void refer(Sequence& sequence, std::vector<Part>& parts) {
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(parts.size());
  sequence._buffer = parts.data();
}

template <class Held>
dds::reply as_reply(const std::shared_ptr<Held>& held) {
  return {held, &held->message};
}

template <class Sequence>
auto span_of(const Sequence& sequence) {
  return std::span(sequence._buffer, sequence._length);
}

/// The message refers to texts of `held`.
[[nodiscard]] rcl_interfaces_msg_dds__ParameterValue_ message_of(
    const g4lidar::parameter_value& value, auto& held) {
  rcl_interfaces_msg_dds__ParameterValue_ made{};
  made.type = static_cast<std::uint8_t>(value.index());
  made.string_value = held.text("");
  if (const auto* flag = std::get_if<bool>(&value)) made.bool_value = *flag;
  if (const auto* whole = std::get_if<std::int64_t>(&value)) made.integer_value = *whole;
  if (const auto* number = std::get_if<double>(&value)) made.double_value = *number;
  if (const auto* text = std::get_if<std::string>(&value)) made.string_value = held.text(*text);
  return made;
}

/// Nothing for a type that no parameter has, too.
[[nodiscard]] g4lidar::parameter_value value_of(
    const rcl_interfaces_msg_dds__ParameterValue_& from);
/// Whether a name is `prefix`, or below it by less than `depth` dots; 0: by any number. *Pure.*
[[nodiscard]] bool is_below(std::string_view name, std::string_view prefix, std::uint64_t depth);

}  // namespace g4_tool
