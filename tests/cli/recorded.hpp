// SPDX-License-Identifier: MIT
// Recordings of a simulated lidar, made by g4-dump itself, or in virtual time.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "g4lidar/recording/writer.hpp"
#include "program.hpp"
#include "support/virtual_transport.hpp"

namespace cli {

/// Records so many scans of a simulated lidar in real time.
inline outcome record_scans(const std::string& file, int scans,
                            const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"record", "sim:?seed=3", "-o", file, "-n", std::to_string(scans)};
  words.insert(words.end(), more.begin(), more.end());
  return run(words);
}

/// The same in virtual time, of a G4: on a busy machine, too, it has no gaps.
inline void record_in_virtual_time(const std::string& file, int scans) {
  auto writer = g4lidar::recording_writer::create(file);
  ASSERT_TRUE(writer);
  g4lidar::test::virtual_bench bench;
  auto device = g4lidar::lidar::open(
      *g4lidar::recorded(std::make_unique<g4lidar::test::virtual_connector>(bench), *writer));
  ASSERT_TRUE(device && device->start());
  for (int i = 0; i < scans; ++i) ASSERT_TRUE(device->wait_scan(std::chrono::seconds(1)));
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
