// SPDX-License-Identifier: MIT
#include "logger.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "common_options.hpp"

namespace g4_dump {
namespace {

std::string printable_lines(std::string_view text) {
  std::string shown;
  while (true) {
    const std::size_t end = text.find('\n');
    shown += printable(text.substr(0, end));
    if (end == std::string_view::npos) return shown;
    shown += '\n';
    text.remove_prefix(end + 1);
  }
}

}  // namespace

std::string counted(unsigned long long number, std::string_view noun) {
  return fmt::format("{} {}{}", number, noun, number == 1 ? "" : "s");
}

std::string wrapped(std::string_view words, std::size_t column, std::size_t indent) {
  constexpr std::size_t width = 98;
  std::string text;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    if (column + 1 + end > width && column > indent) {
      text.append("\n").append(indent, ' ');
      column = indent;
    } else if (!text.empty()) {
      text += ' ';
      ++column;
    }
    text.append(words.substr(0, end));
    column += end;
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return text;
}

std::string json_line(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

namespace logger {

void info(std::string_view message) {
  if (!our_global_options().quiet) write(printable_lines(message));
}

void verbose(std::string_view message) {
  if (our_global_options().verbose) write(printable_lines(message));
}

void error(std::string_view sentences, exit_code code, std::string_view problem) {
  if (!our_global_options().json_errors) {
    return write("g4-dump: " + printable_lines(sentences) + "\n");
  }
  nlohmann::ordered_json line;
  line["error"] = sentences;
  if (!problem.empty()) line["problem"] = problem;
  line["exit_code"] = static_cast<int>(code);
  write(json_line(line));
}

void write(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t count = ::write(2, text.data(), text.size());
    if (count <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace logger
}  // namespace g4_dump
