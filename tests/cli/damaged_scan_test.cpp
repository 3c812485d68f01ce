// SPDX-License-Identifier: MIT
// Revolutions that g4-dump makes of damaged bytes, against what the simulated device truly measured: all but
// one in a hundred of the intact points are in them, and none is of two turns.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/core/command.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/world.hpp"
#include "program.hpp"
#include "support/laser_scan.hpp"
#include "support/mcap_messages.hpp"
#include "support/measured_truth.hpp"

namespace {

using cli::outcome;
using cli::run;
using g4lidar::test::direction_of;
using g4lidar::test::laser_scan;
using g4lidar::test::looks_like;
using g4lidar::test::measured_truth;
using g4lidar::test::read_laser_scan;
using nlohmann::json;
namespace sim = g4lidar::sim;

struct damage {
  const char* name;
  const char* fault;
};

class DamagedScan : public cli::scratch, public testing::WithParamInterface<damage> {
 protected:
  static constexpr std::int64_t second = 1'000'000'000;

  /// Half a minute of a lidar whose bytes are damaged: in a file, and what it measured. Its ranges differ
  /// from turn to turn, so that each belongs to one turn.
  void SetUp() override {
    const auto read = sim::parse_fault(GetParam().fault);
    const auto* const fault = std::get_if<sim::fault>(&read);
    ASSERT_NE(fault, nullptr);
    sim::device_options options;
    options.truth_capacity = 300'000;
    options.scanner.noise_mm = 8.0;
    sim::device simulated(sim::built_in_world(), options, std::span(fault, 1));
    std::string bytes;
    std::array<std::uint8_t, 4096> memory{};
    simulated.write(g4lidar::encode(g4lidar::command::start), second);
    for (std::int64_t now = second; now < 31 * second; now += 10'000'000) {
      while (const std::size_t count = simulated.read(memory, now)) {
        bytes.append(memory.begin(), memory.begin() + static_cast<std::ptrdiff_t>(count));
      }
    }
    cli::write_file(path("raw.bin"), bytes);
    truth_ = measured_truth::of(simulated, options.truth_capacity);
    ASSERT_GT(truth_.samples().size(), 250'000U);
  }

  measured_truth truth_;
};

TEST_P(DamagedScan, HoldsTheIntactPointsAndNoneIsMerged) {
  const outcome done = run({"scan", path("raw.bin"), "-f", "jsonl"});
  ASSERT_EQ(done.code, 0) << done.err;
  std::size_t delivered = 0;
  std::size_t unknown = 0;
  std::size_t window = 3'000;  // the first piece is left out
  std::vector<std::size_t> sizes;
  for (const std::string& line : cli::lines_of(done.out)) {
    const json scan = json::parse(line);
    const std::vector<double> angles = scan.at("angle_deg");
    const std::vector<double> ranges = scan.at("range_mm");
    sizes.push_back(angles.size());
    std::map<std::uint64_t, std::size_t> of;  // how many points of which turn
    std::size_t found = 0;
    for (std::size_t i = 0; i < angles.size(); ++i) {
      const auto* const truth = truth_.next(window, [&](const sim::sample_truth& each) {
        return looks_like(each, angles[i], ranges[i]);
      });
      if (truth == nullptr) continue;
      window = 1'280;  // less than a turn has
      ++found;
      ++of[truth->revolution];
    }
    std::size_t most = 0;
    for (const auto& [revolution, count] : of) most = std::max(most, count);
    EXPECT_LE(found - most, 2U) << "revolution " << scan.at("scan") << " is merged";
    EXPECT_LE(scan.at("turned_deg"), 361.0 + 45.0);
    delivered += found;
    unknown += angles.size() - found;
  }
  const auto intact = static_cast<double>(truth_.intact());
  EXPECT_GE(static_cast<double>(delivered), 0.99 * intact);
  EXPECT_LE(static_cast<double>(unknown), intact / 1000);  // damage that no checksum finds
  // csv has a row for each of them.
  const std::vector<std::string> rows =
      cli::lines_of(run({"scan", path("raw.bin"), "-f", "csv"}).out);
  ASSERT_EQ(rows.size(), sizes.size() + 1);
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const std::size_t time = rows[i + 1].find(',') + 1;
    const std::size_t points = rows[i + 1].find(',', time) + 1;
    EXPECT_EQ(std::stoul(rows[i + 1].substr(points)), sizes[i]) << rows[i + 1];
  }
}

/// A turn as the messages have it: its samples by the bin of their direction.
class turn_in_bins {
 public:
  explicit turn_in_bins(std::size_t bins) : samples_(bins) {}

  void add(const sim::sent_sample& sent) {
    const double robot_deg = std::remainder(180.0 - direction_of(sent.truth), 360.0);
    const auto bins = static_cast<double>(samples_.size());
    const auto bin = static_cast<std::size_t>(std::lround((robot_deg + 180.0) / 360.0 * bins));
    samples_[bin % samples_.size()].push_back({sent.truth.raw, sent.whole});
  }
  /// Whether a range of a bin is one of this turn; a border may be missed by the rounding of angles.
  [[nodiscard]] bool has(std::size_t bin, float range_m) const {
    const long raw = std::lround(static_cast<double>(range_m) * 4000.0);
    const auto is_it = [raw](const measured& each) { return each.raw == raw; };
    for (const std::size_t near : around(bin)) {
      if (std::any_of(samples_[near].begin(), samples_[near].end(), is_it)) return true;
    }
    return false;
  }
  /// How many of the intact samples are in the message: something was seen in their directions.
  [[nodiscard]] std::size_t covered_by(const laser_scan& scan) const {
    std::size_t count = 0;
    for (std::size_t bin = 0; bin < samples_.size(); ++bin) {
      const auto near = around(bin);
      const bool is_seen = std::any_of(near.begin(), near.end(), [&](std::size_t each) {
        return !std::isnan(scan.ranges[each]);
      });
      if (!is_seen) continue;
      count += static_cast<std::size_t>(
          std::count_if(samples_[bin].begin(), samples_[bin].end(),
                        [](const measured& each) { return each.is_intact; }));
    }
    return count;
  }

 private:
  struct measured {
    std::uint16_t raw;
    bool is_intact;
  };

  [[nodiscard]] std::array<std::size_t, 3> around(std::size_t bin) const {
    const std::size_t size = samples_.size();
    return {(bin + size - 1) % size, bin, (bin + 1) % size};
  }

  std::vector<std::vector<measured>> samples_;
};

TEST_P(DamagedScan, IsALaserScanOfTheRecording) {
  const std::string file = path("walk.mcap");
  const outcome done = run({"record", path("raw.bin"), file});
  ASSERT_EQ(done.code, 0) << done.err;
  std::map<std::uint64_t, turn_in_bins> turns;
  for (const sim::sent_sample& each : truth_.samples()) {
    turns.try_emplace(each.truth.revolution, 720).first->second.add(each);
  }
  auto from = turns.begin();
  std::size_t covered = 0;
  const auto messages = g4lidar::test::mcap_messages(cli::read_file(file), "/scan");
  for (const std::vector<std::uint8_t>& message : messages) {
    const laser_scan scan = read_laser_scan(message);
    ASSERT_EQ(scan.ranges.size(), 720U);
    // The turn that most of its ranges are of, behind that of the message before.
    std::size_t ranges = 0;
    std::size_t most = 0;
    auto best = from;
    for (auto turn = from; turn != turns.end() && std::distance(from, turn) < 5; ++turn) {
      std::size_t own = 0;
      ranges = 0;
      for (std::size_t bin = 0; bin < scan.ranges.size(); ++bin) {
        if (!std::isfinite(scan.ranges[bin])) continue;
        ++ranges;
        own += turn->second.has(bin, scan.ranges[bin]);
      }
      if (own > most) best = turn;
      most = std::max(most, own);
    }
    ASSERT_GT(most, 0U) << "no turn like this was left";
    EXPECT_LE(ranges - most, 4U) << "turn " << best->first << " is merged with another";
    covered += best->second.covered_by(scan);
    from = std::next(best);
  }
  EXPECT_GE(static_cast<double>(covered), 0.99 * static_cast<double>(truth_.intact()));
  EXPECT_LE(messages.size(), turns.size());
}

INSTANTIATE_TEST_SUITE_P(Of, DamagedScan,
                         testing::Values(damage{"OneFlippedInThousand", "flip*0.001@2s"},
                                         damage{"OneByteDroppedInThousand", "drop*0.001@2s"}),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
