// SPDX-License-Identifier: MIT
// A recording is a device: what comes out of it is what came out of the device.
#include "g4lidar/replay.hpp"

#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "recorded_life.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
constexpr std::int64_t second = 1'000'000'000;

/// Does what a program may do, in an order that the seed says.
class program {
 public:
  program(lidar& device, std::uint64_t seed) : device_(device), dice_(seed), all_(device) {}

  void step(outcome_of_life& life) {
    const unsigned what = static_cast<unsigned>(dice_() % 100);
    if (what < 60) {
      const auto scan = device_.next_scan(300ms);
      if (scan) life.scans.emplace_back(scan->points.begin(), scan->points.end());
    } else if (what < 80) {
      static_cast<void>(device_.next_points(20ms));
    } else if (what < 90) {
      static_cast<void>(device_.process());
    } else if (what < 92) {
      static_cast<void>(device_.stop());
    } else if (what < 94) {
      static_cast<void>(device_.ask(requests::health(), while_scanning::stop_and_resume));
    } else if (what < 96) {
      static_cast<void>(device_.ask(requests::set(ranging_frequency(dice_() % 3)),
                                    while_scanning::stop_and_resume));
    } else if (what < 97) {
      device_.wake();
    } else {
      static_cast<void>(device_.start());
    }
    all_.points(life);
  }

 private:
  lidar& device_;
  std::mt19937_64 dice_;
  collector all_;
};

struct life_case {
  std::string_view name;
  std::vector<std::string_view> faults;
  std::chrono::milliseconds batch{0};
  bool only_scans = false;
};

outcome_of_life live(const life_case& of, std::uint64_t seed, recording_writer& into) {
  sim::device_options how;
  how.scanner.seed = seed;
  const auto faults = faults_of(of.faults);
  virtual_bench bench(how, faults);
  lidar_options options;
  options.reconnect = true;
  options.batch = of.batch;
  if (seed % 3 == 1) options.protection = power_down_protection::on;
  into.set_wall_clock(1'700'000'000 * second);
  outcome_of_life life;
  auto line = recorded(std::make_unique<virtual_connector>(bench), into);
  auto device = lidar::open(std::move(*line), options);
  if (!device) {
    ADD_FAILURE() << device.error().message();
    return life;
  }
  into.device({.information = device->information()});
  {
    program user(*device, seed);  // who does not read its ring misses nothing of what is compared
    static_cast<void>(device->start());
    while (bench.now_ns < 15 * second) {
      if (of.only_scans) {
        const auto scan = device->next_scan(500ms);
        if (scan) life.scans.emplace_back(scan->points.begin(), scan->points.end());
      } else {
        user.step(life);
      }
    }
  }
  static_cast<void>(device->close());
  life.counts = device->counts();
  return life;
}

/// Everything that a file gives, but for how the line stands now and then, as a text.
std::vector<std::string> items_of(const std::string& path) {
  std::vector<std::string> all;
  auto reader = recording_reader::open(path);
  if (!reader) {
    ADD_FAILURE() << reader.error().message();
    return all;
  }
  while (true) {
    const auto item = reader->next();
    if (!item || !*item) {
      EXPECT_TRUE(item);
      break;
    }
    const line_note& note = (*item)->note;
    if ((*item)->what == recorded_item::kind::note && note.what == line_note::kind::state) continue;
    std::ostringstream text;
    text << static_cast<int>((*item)->what) << ' ' << (*item)->time_ns << ' ' << (*item)->wall_ns
         << ' ' << name_of(note.what) << ' ' << name_of(note.reason) << ' ' << note.delivers << ' '
         << note.baud << ' ' << note.samples_per_second << ' ' << note.unparsed << ' '
         << note.events << ' ' << note.line << ' ';
    for (const std::uint8_t byte : (*item)->data) text << static_cast<int>(byte) << ',';
    all.push_back(text.str());
  }
  EXPECT_FALSE(reader->damage().any());
  return all;
}

void expect_same_recording(const std::string& one, const std::string& other) {
  const auto wanted = items_of(one);
  const auto got = items_of(other);
  EXPECT_EQ(wanted.size(), got.size());
  EXPECT_FALSE(wanted.empty());
  for (std::size_t i = 0; i < std::min(wanted.size(), got.size()); ++i) {
    ASSERT_EQ(wanted[i], got[i]) << i;
  }
}

class Replay : public testing::TestWithParam<life_case> {};

TEST_P(Replay, GivesTheSamePoints) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE(seed);
    const temporary_path path;
    auto writer = recording_writer::create(path.text());
    ASSERT_TRUE(writer) << writer.error().message();
    const outcome_of_life before = live(GetParam(), seed, *writer);
    ASSERT_TRUE(writer->close());
    EXPECT_GT(before.points.size(), 10'000U);

    auto line = replay::open(path.text());
    ASSERT_TRUE(line) << line.error().message();
    const temporary_path copy;
    auto again = recording_writer::create(copy.text());
    ASSERT_TRUE(again) << again.error().message();
    line = recorded(std::move(*line), *again);
    const outcome_of_life after = replayed(std::move(*line), seed % 2 == 0);
    expect_same_points(before.points, after.points);
    EXPECT_TRUE(again->close());
    EXPECT_EQ(again->digest().payload, writer->digest().payload);
    expect_same_recording(path.text(), copy.text());
    EXPECT_EQ(before.counts.stream, after.counts.stream);
    EXPECT_EQ(before.counts.bytes, after.counts.bytes);
    EXPECT_EQ(before.counts.scans, after.counts.scans);
    EXPECT_EQ(before.counts.partial_scans, after.counts.partial_scans);
    EXPECT_EQ(before.counts.samples_lost, after.counts.samples_lost);
    EXPECT_EQ(before.counts.largest_gap_ns, after.counts.largest_gap_ns);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, Replay,
    testing::Values(life_case{"Healthy", {}}, life_case{"Flip", {"flip*0.002"}},
                    life_case{"Drop", {"drop*0.002"}}, life_case{"Insert", {"insert*0.002"}},
                    life_case{"Unplug", {"unplug@3s+1s", "unplug@8s+500ms"}},
                    life_case{"Scanning", {"scanning@0"}}, life_case{"Jolt", {"jolt*0.02"}},
                    life_case{"Batch", {"batch=16ms"}}, life_case{"OwnBatch", {}, 20ms},
                    life_case{"Truncate", {"truncate*0.02"}},
                    life_case{"Stall", {"stall@4s+2s", "stall@9s+300ms"}},
                    life_case{"Reboot", {"reboot@5s+1s"}},
                    life_case{"Everything",
                              {"flip*0.001", "drop*0.0005", "batch=16ms", "unplug@4s+700ms",
                               "jolt*0.01", "late=50ms*0.3", "stall@8s+1500ms", "wrong*0.1"}}),
    [](const auto& of) { return std::string(of.param.name); });

TEST(ReplayScans, AreTheSame) {
  const temporary_path path;
  auto writer = recording_writer::create(path.text());
  ASSERT_TRUE(writer) << writer.error().message();
  const life_case quiet{"Scans", {"flip*0.001"}, 0ms, true};
  const outcome_of_life before = live(quiet, 2, *writer);
  ASSERT_TRUE(writer->close());
  auto line = replay::open(path.text());
  ASSERT_TRUE(line) << line.error().message();
  const outcome_of_life after = replayed(std::move(*line));
  ASSERT_GE(before.scans.size(), 80U);
  ASSERT_GE(after.scans.size(), before.scans.size());
  for (std::size_t i = 0; i < before.scans.size(); ++i) {
    expect_same_points(before.scans[i], after.scans[i]);
  }
}

}  // namespace
}  // namespace g4lidar::test
