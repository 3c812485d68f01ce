// SPDX-License-Identifier: MIT
#include "report.hpp"

#include <nlohmann/json.hpp>
#include <string>

#include "manners.hpp"
#include "say.hpp"

namespace g4_dump {

void report(std::string_view sentences, exit_code code, std::string_view problem) {
  if (!our_manners().json_errors) return say("g4-dump: " + std::string(sentences) + "\n");
  nlohmann::ordered_json line;
  line["error"] = sentences;
  if (!problem.empty()) line["problem"] = problem;
  line["exit_code"] = static_cast<int>(code);
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;  // a name may be no UTF-8
  say(line.dump(-1, ' ', false, replace) + "\n");
}

}  // namespace g4_dump
