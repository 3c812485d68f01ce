// SPDX-License-Identifier: MIT
// What dump, decode, convert and replay write, each against points that are worked out here from the
// bytes, in double precision and by another parser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "expected_points.hpp"
#include "program.hpp"
#include "recorded.hpp"
#include "support/cdr_reader.hpp"
#include "support/mcap_messages.hpp"

namespace {

using cli::expect_counted_times;
using cli::row;
using cli::rows_of;
using cli::run;
using nlohmann::json;

constexpr double degrees_of_radian = 180.0 / std::numbers::pi;

class Independent : public cli::scratch {
 protected:
  void SetUp() override {
    const std::string name = path("raw.bin");
    ASSERT_EQ(run({"sim", "--seconds", "1", "--seed", "11", "-o", name}).code, 0);
    bytes_ = cli::read_file(name);
    expected_ = cli::points_in(bytes_);
    ASSERT_GT(expected_.size(), 8900U);
    ASSERT_EQ(expected_.back().scan, 7U) << "7 Hz";
  }

  void expect_points(const std::vector<row>& rows) const { cli::expect_points(rows, expected_); }
  /// As a driver estimates them.
  static void expect_even_times(const std::vector<row>& rows) {
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const std::int64_t step_ns = rows[i].time_ns - rows[i - 1].time_ns;
      ASSERT_GE(step_ns, 0) << i;
      ASSERT_LT(step_ns, 20'000'000) << i;  // the estimate is corrected now and then
    }
    const auto taken_ns = static_cast<double>(rows.back().time_ns - rows.front().time_ns);
    EXPECT_NEAR(taken_ns, static_cast<double>(rows.size() - 1) * 1e9 / 9000.0, 20e6);
  }
  [[nodiscard]] std::string recording() const {
    std::string name = path("walk.mcap");
    EXPECT_EQ(run({"convert", path("raw.bin"), name}).code, 0);
    return name;
  }

  std::string bytes_;
  std::vector<cli::expected_point> expected_;
};

TEST_F(Independent, RawBytes) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"decode", path("raw.bin")},
           {"dump", path("raw.bin"), "-f", "csv"},
           {"convert", path("raw.bin"), "-", "--to-format", "csv"}}) {
    SCOPED_TRACE(words[0]);
    const std::vector<row> rows = rows_of(run(words).out);
    expect_points(rows);
    expect_counted_times(rows);
  }
}

TEST_F(Independent, ARecording) {
  const std::string name = recording();
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"dump", name, "-f", "csv"},
                                             {"replay", name, "-f", "csv"},
                                             {"convert", name, "-", "--to-format", "csv"}}) {
    SCOPED_TRACE(words[0]);
    const std::vector<row> rows = rows_of(run(words).out);
    expect_points(rows);
    expect_even_times(rows);
  }
}

// Times of a recording made of raw bytes are those of a driver, which knows them well after 5 s.
TEST_F(Independent, TimesOfARecordingOfRawBytes) {
  const std::string bytes = run({"sim", "--seconds", "8", "--seed", "12"}).out;
  cli::write_file(path("long.bin"), bytes);
  const std::string name = path("long.mcap");
  ASSERT_EQ(run({"convert", path("long.bin"), name}).code, 0);
  const std::vector<row> rows = rows_of(run({"convert", name, "-", "--to-format", "csv"}).out);
  cli::expect_points(rows, cli::points_in(bytes));
  constexpr std::size_t settled = 45'000;
  ASSERT_GT(rows.size(), settled + 20'000);
  const std::int64_t shift_ns = rows[60'000].time_ns - cli::counted_time_ns(60'000);
  for (std::size_t i = settled; i < rows.size(); ++i) {
    ASSERT_LT(std::llabs(rows[i].time_ns - cli::counted_time_ns(i) - shift_ns), 1'000'000) << i;
  }
}

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

// The returns of the first whole revolution, which is number 1: the stream begins within number 0.
TEST_F(Independent, APointCloud) {
  const std::string cloud = path("cloud.pcd");
  ASSERT_EQ(run({"convert", path("raw.bin"), cloud, "--ascii"}).code, 0);
  std::istringstream text(cli::read_file(cloud));
  std::string line;
  while (std::getline(text, line) && line != "DATA ascii") {
  }
  std::uint64_t which = 0;
  while (expected_[0].scan == which) ++which;
  ASSERT_EQ(which, 1U);
  std::size_t count = 0;
  for (const cli::expected_point& p : expected_) {
    if (p.scan != which || p.range_mm == 0.0) continue;
    double x = 0.0;
    double y = 0.0;
    double z = 0.0;
    double range = 0.0;
    double angle = 0.0;
    std::int64_t time_ns = 0;
    ASSERT_TRUE(text >> x >> y >> z >> range >> angle >> time_ns);
    ++count;
    ASSERT_NEAR(x, p.range_mm / 1000.0 * std::cos(p.angle_deg / degrees_of_radian), 1e-4);
    ASSERT_NEAR(y, p.range_mm / 1000.0 * std::sin(p.angle_deg / degrees_of_radian), 1e-4);
    ASSERT_EQ(z, 0.0);
    ASSERT_NEAR(range, p.range_mm / 1000.0, 1e-6);
    ASSERT_LT(std::abs(std::remainder(angle - p.angle_deg, 360.0)), 1e-4);
  }
  EXPECT_GT(count, 1000U);
  EXPECT_FALSE(text >> line) << "more points than returns";
}

}  // namespace
