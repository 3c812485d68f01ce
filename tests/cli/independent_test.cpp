// SPDX-License-Identifier: MIT
// What dump, convert and replay write of a recording, against points that are worked out here from the bytes, in double
// precision and by another parser.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "expected_points.hpp"
#include "program.hpp"
#include "recorded.hpp"
#include "support/cdr_reader.hpp"
#include "support/mcap_messages.hpp"

namespace {

using cli::row;
using cli::rows_of;
using cli::run;

class Independent : public cli::scratch {};

/// The bytes that came from the lidar, taken from the file without the library.
std::string recorded_bytes(const std::string& name) {
  std::string bytes;
  for (const auto& message :
       g4lidar::test::mcap_messages(cli::read_file(name), "/g4lidar/from_device")) {
    g4lidar::test::cdr_reader read(message);
    static_cast<void>(read.number<std::int64_t>());
    const auto count = read.number<std::uint32_t>();
    bytes.append(message.end() - static_cast<std::ptrdiff_t>(count), message.end());
  }
  return bytes;
}

// A lidar in real time, as it was recorded: what came behind the command to stop is no point of it.
TEST_F(Independent, ARecordingOfALidar) {
  const std::string name = path("live.mcap");
  ASSERT_EQ(cli::record_scans(name, 4).code, 0);
  const std::vector<cli::expected_point> all = cli::points_in(recorded_bytes(name));
  const std::vector<std::vector<std::string>> ways{
      {"dump", name, "-f", "csv"},
      {"replay", name, "-f", "csv", "--playback-speed", "max"},
      {"convert", name, "-", "--to-format", "csv"}};
  for (const std::vector<std::string>& each : ways) {
    SCOPED_TRACE(each[0]);
    const std::vector<row> rows = rows_of(run(each).out);
    ASSERT_LE(rows.size(), all.size());
    EXPECT_GE(rows.size(), 4U * 1'200) << "four revolutions at 9 kHz and 7 Hz";
    cli::expect_points(rows, {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(rows.size())});
    for (std::size_t i = 1; i < rows.size(); ++i) ASSERT_GE(rows[i].time_ns, rows[i - 1].time_ns);
  }
}

}  // namespace
