// SPDX-License-Identifier: MIT
// The messages of the program, on standard error.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "exit_code.hpp"
#include "g4lidar/export/printable.hpp"

namespace g4_dump {

using g4lidar::printable;

/// `name` as it stands in sentences.
[[nodiscard]] inline std::string in_quotes(const std::string& name) { return "'" + name + "'"; }

/// How many there are of something: "1 packet", "0 packets", "2 packets".
[[nodiscard]] std::string counted(unsigned long long number, std::string_view noun);

/// Words in lines that fit a terminal. The first begins at `column`, all others after `indent`
/// blanks.
[[nodiscard]] std::string wrapped(std::string_view words, std::size_t column, std::size_t indent);

/// One line of JSON. Everything but ASCII is escaped, and what is not UTF-8 is replaced.
[[nodiscard]] std::string json_line(const nlohmann::ordered_json& value);

}  // namespace g4_dump

/// Each line of a message passes through printable(). A message that cannot be written is dropped.
namespace g4_dump::logger {

/// A message with its line breaks; not with -q.
void info(std::string_view message);
/// A message with its line breaks; with -v only.
void verbose(std::string_view message);
/// "g4-dump: SENTENCES", or with --json-errors {"error":SENTENCES,"problem":...,"exit_code":N}.
void error(std::string_view sentences, exit_code code, std::string_view problem = {});
/// Bytes as they are, whatever the options: for lines that are drawn over, and for output that the
/// user asked for on standard error.
void write(std::string_view text) noexcept;

}  // namespace g4_dump::logger
