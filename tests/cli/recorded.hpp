// SPDX-License-Identifier: MIT
// Recordings of a simulated lidar, made by g4-dump itself.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "program.hpp"

namespace cli {

/// Records so many scans of a simulated lidar in real time.
inline outcome record_scans(const std::string& file, int scans,
                            const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"record", "sim:?seed=3", "-o", file, "-n", std::to_string(scans)};
  words.insert(words.end(), more.begin(), more.end());
  return run(words);
}

/// Its points as rows of csv, below a header, with times of the steady clock.
inline std::vector<std::string> points_of(const std::string& file,
                                          const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"replay",           file, "-f", "csv", "--time", "mono",
                                 "--playback-speed", "max"};
  words.insert(words.end(), more.begin(), more.end());
  return lines_of(run(words).out);
}

/// The line of `words` that begins with `begin`; empty where there is none.
inline std::string line_with(const std::string& words, std::string_view begin) {
  for (const std::string& line : lines_of(words)) {
    if (line.rfind(begin, 0) == 0) return line;
  }
  return {};
}

/// The number in column `column` of a csv's row.
inline long long number_in(const std::string& row, std::size_t column) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < column; ++i) at = row.find(',', at) + 1;
  return std::stoll(row.substr(at));
}

/// Where, in the file of a recording, bytes of the lidar lie that came in its middle.
inline std::size_t place_of_payload(const std::string& file, const std::string& payload) {
  for (std::size_t at = payload.size() / 2; at + 16 < payload.size(); ++at) {
    const std::size_t found = file.find(payload.substr(at, 16));  // a reading may end within it
    if (found != std::string::npos) return found;
  }
  return 0;
}

}  // namespace cli
