// SPDX-License-Identifier: MIT
#include "config_file.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <string_view>

#include "logger.hpp"
#include "suggestion.hpp"

namespace g4_tool {

std::string config_text(std::istream& in, std::string& problem) {
  constexpr std::size_t most = 1'000'000;
  std::string text(most + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);  // of an editor of Windows
  if (in.bad()) problem = "the file cannot be read";
  if (text.size() > most) problem = "the file is longer than 1 MB";
  return text;
}

std::string problem_in_file(std::string line, const std::vector<std::string>& options) {
  constexpr std::string_view section = ".++";
  if (line.ends_with(section)) line.resize(line.size() - section.size());
  const std::size_t colon = line.find(':');
  if (colon == std::string::npos || (colon + 1 < line.size() && line[colon + 1] != ' ')) {
    return "unknown option " + in_quotes(line) + " in the file of --config" +
           did_you_mean(line, options);
  }
  const std::string name = line.substr(0, colon);
  const std::size_t begin = line.find_first_not_of(' ', colon + 1);
  if (begin == std::string::npos) return in_quotes(line) + " is YAML; --config reads TOML";
  const std::string value = line.substr(begin);
  const bool is_word = value.find_first_not_of("0123456789.+-") != std::string::npos &&
                       value != "true" && value != "false" && value.front() != '"';
  return fmt::format("{} is YAML; --config reads TOML: {} = {}{}{}", in_quotes(line), name,
                     is_word ? "\"" : "", value, is_word ? "\"" : "");
}

}  // namespace g4_tool
