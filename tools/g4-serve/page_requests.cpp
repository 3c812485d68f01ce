// SPDX-License-Identifier: MIT
#include "page_protocol.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

#include "client_json.hpp"

namespace g4_tool {
namespace {

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
  const auto lidar = object.find("lidar");
  if (lidar != object.end() && !lidar->is_string()) {
    return bad_request{"set", "lidar is not the name of one"};
  }
  return set_request{name->get<std::string>(), word,
                     lidar == object.end() ? "" : lidar->get<std::string>()};
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

}  // namespace g4_tool
