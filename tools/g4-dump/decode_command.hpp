// SPDX-License-Identifier: MIT
// The verb decode: raw bytes in, points out.
#pragma once

#include <cstdint>
#include <string>

#include "point_writer.hpp"

namespace g4_dump {

enum class stats_format : std::uint8_t { words, json };

struct decode_options {
  std::string input = "-";
  std::string output = "-";
  point_style style;
  stats_format stats = stats_format::words;
};

/// Returns the exit code; throws a failure.
[[nodiscard]] int run(const decode_options& options);

}  // namespace g4_dump
