// SPDX-License-Identifier: MIT
// A recording is a device: what comes out of it is what came out of the device.
#include "g4lidar/core/response.hpp"
#include "g4lidar/recording/reader.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <sstream>

#include "recorded_run.hpp"
#include "support/test_scale.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
constexpr std::int64_t second = 1'000'000'000;

/// Does what a program may do, in an order that the seed determines.
class program {
 public:
  program(lidar& device, std::uint64_t seed) : device_(device), dice_(seed) {}

  void step(run_result& run) {
    const unsigned what = static_cast<unsigned>(dice_() % 100);
    if (what < 60) {
      const auto scan = device_.try_scan(300ms);
      if (scan) run.scans.emplace_back(scan->points.begin(), scan->points.end());
    } else if (what < 80) {
      static_cast<void>(device_.next_points(20ms));
    } else if (what < 90) {
      static_cast<void>(device_.event_loop().process());
    } else if (what < 92) {
      static_cast<void>(device_.stop());
    } else if (what < 94) {
      static_cast<void>(device_.ask(requests::health(), while_scanning::stop_and_resume));
    } else if (what < 96) {
      static_cast<void>(device_.ask(
          requests::set(*reply_byte<sample_rate>(static_cast<std::uint8_t>(dice_() % 3))),
          while_scanning::stop_and_resume));
    } else if (what < 97) {
      device_.wake();
    } else {
      static_cast<void>(device_.start());
    }
  }

 private:
  lidar& device_;
  std::mt19937_64 dice_;
};

struct run_case {
  std::string_view name;
  std::vector<std::string_view> faults;
  std::chrono::milliseconds batch{0};
  bool only_scans = false;
};

run_result live(const run_case& of, std::uint64_t seed, recording_writer& into) {
  sim::device_options how;
  how.scanner.seed = seed;
  const auto faults = faults_of(of.faults);
  virtual_bench bench(how, faults);
  lidar_options options;
  options.reconnect = true;
  options.tuning.batch = of.batch;
  if (seed % 3 == 1) options.protection = power_down_protection::on;
  into.set_wall_clock(1'700'000'000 * second);
  run_result run;
  auto from = recorded(std::make_unique<virtual_connector>(bench), into);
  auto device = lidar::open(std::move(*from), options);
  if (!device) {
    ADD_FAILURE() << device.error().message();
    return run;
  }
  into.device({.information = device->information()});
  collector all(*device);
  {
    program user(*device, seed);
    static_cast<void>(device->start());
    while (bench.now_ns < 15 * second) {
      if (of.only_scans) {
        const auto scan = device->try_scan(500ms);
        if (scan) run.scans.emplace_back(scan->points.begin(), scan->points.end());
        std::array<sim::sent_sample, 256> some;
        while (const std::size_t count = bench.device.take_truth(some)) {
          run.sent.insert(run.sent.end(), some.begin(),
                          some.begin() + static_cast<std::ptrdiff_t>(count));
        }
      } else {
        user.step(run);
      }
      all.points(run);
    }
  }
  static_cast<void>(device->close());
  all.points(run);
  run.counts = device->counts();
  return run;
}

/// Everything that a file gives, but for how the transport stands now and then, as a text.
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
    const recorded_event& other = (*item)->other;
    if ((*item)->what == recorded_item::kind::other && other.what == recorded_event::kind::state)
      continue;
    std::ostringstream text;
    text << static_cast<int>((*item)->what) << ' ' << (*item)->time_ns << ' ' << (*item)->wall_ns
         << ' ' << name_of(other.what) << ' ' << name_of(other.reason) << ' ' << other.delivers
         << ' ' << other.baud << ' ' << other.sample_rate_hz << ' ' << other.unparsed << ' '
         << other.events << ' ' << other.name << ' ';
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

/// Each point of the file is in exactly one scan or piece.
void expect_every_point_in_a_scan(const std::string& path, std::size_t wanted) {
  auto from = replay::open(path);
  ASSERT_TRUE(from) << from.error().message();
  lidar_options options;
  options.partial_scans = true;
  const run_result run = replayed(std::move(*from), true, options);
  std::size_t points = 0;
  for (const auto& scan : run.scans) points += scan.size();
  EXPECT_EQ(points, wanted);
  EXPECT_EQ(points, run.counts.stream.points);
  EXPECT_EQ(run.counts.scans_missed, 0U);
  EXPECT_EQ(run.scans.size(), run.counts.scans + run.counts.partial_scans);
}

class Replay : public testing::TestWithParam<run_case> {};

TEST_P(Replay, GivesTheSamePoints) {
  for (const int each : test::seeds(2)) {
    SCOPED_TRACE(each);
    const auto seed = static_cast<std::uint64_t>(each);
    const temporary_path path;
    auto writer = recording_writer::create(path.text());
    ASSERT_TRUE(writer) << writer.error().message();
    const run_result before = live(GetParam(), seed, *writer);
    ASSERT_TRUE(writer->close());
    EXPECT_GT(before.points.size(), 10'000U);
    EXPECT_EQ(before.counts.stream.points, before.points.size()) << "what is counted is delivered";

    auto from = replay::open(path.text());
    ASSERT_TRUE(from) << from.error().message();
    const temporary_path copy;
    auto again = recording_writer::create(copy.text());
    ASSERT_TRUE(again) << again.error().message();
    from = recorded(std::move(*from), *again);
    const run_result after = replayed(std::move(*from), seed % 2 == 0);
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
    expect_every_point_in_a_scan(path.text(), before.points.size());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, Replay,
    testing::Values(run_case{"Healthy", {}}, run_case{"Flip", {"flip*0.002"}},
                    run_case{"Drop", {"drop*0.002"}}, run_case{"Insert", {"insert*0.002"}},
                    run_case{"Unplug", {"unplug@3s+1s", "unplug@8s+500ms"}},
                    run_case{"Scanning", {"scanning@0"}}, run_case{"Jolt", {"jolt*0.02"}},
                    run_case{"Batch", {"batch=16ms"}}, run_case{"OwnBatch", {}, 20ms},
                    run_case{"Truncate", {"truncate*0.02"}},
                    run_case{"Stall", {"stall@4s+2s", "stall@9s+300ms"}},
                    run_case{"Reboot", {"reboot@5s+1s"}},
                    run_case{"Everything",
                             {"flip*0.001", "drop*0.0005", "batch=16ms", "unplug@4s+700ms",
                              "jolt*0.01", "late=50ms*0.3", "stall@8s+1500ms", "wrong*0.1"}}),
    [](const auto& of) { return std::string(of.param.name); });

/// The ranges of each scan.
using ranges = std::vector<std::vector<float>>;

ranges ranges_of(const std::vector<std::vector<point>>& scans) {
  ranges all;
  for (const auto& scan : scans) {
    auto& into = all.emplace_back();
    for (const point& each : scan) into.push_back(each.range_mm);
  }
  return all;
}

/// The ranges of each revolution that the device has sent from its zero packet to the next one.
ranges revolutions_of(const std::vector<sim::sent_sample>& sent) {
  ranges all;
  for (const sim::sent_sample& each : sent) {
    if (each.zero) all.emplace_back();
    if (!all.empty()) all.back().push_back(static_cast<float>(each.truth.raw) * 0.25F);
  }
  if (!all.empty()) all.pop_back();  // its end was not sent
  return all;
}

TEST(ReplayScans, AreTheRevolutionsThatTheDeviceSent) {
  const temporary_path path;
  auto writer = recording_writer::create(path.text());
  ASSERT_TRUE(writer) << writer.error().message();
  const run_result before = live({"Scans", {}, 0ms, true}, 2, *writer);
  ASSERT_TRUE(writer->close());
  auto from = replay::open(path.text());
  ASSERT_TRUE(from) << from.error().message();
  const ranges sent = revolutions_of(before.sent);
  ASSERT_GE(sent.size(), 80U);
  EXPECT_EQ(ranges_of(before.scans), sent);
  EXPECT_EQ(ranges_of(replayed(std::move(*from)).scans), sent);
}

TEST(ReplayScans, OfADamagedStreamAreThoseThatWereCounted) {
  const temporary_path path;
  auto writer = recording_writer::create(path.text());
  ASSERT_TRUE(writer) << writer.error().message();
  const run_result before = live({"Scans", {"flip*0.001"}, 0ms, true}, 2, *writer);
  ASSERT_TRUE(writer->close());
  auto from = replay::open(path.text());
  ASSERT_TRUE(from) << from.error().message();
  const run_result after = replayed(std::move(*from));
  ASSERT_GE(before.scans.size(), 80U);
  // The program did not take a scan that ended while it closed.
  EXPECT_EQ(after.scans.size(), before.scans.size() + before.counts.scans_missed);
  EXPECT_EQ(after.scans.size(), before.counts.scans);
  for (std::size_t i = 0; i < before.scans.size(); ++i) {
    expect_same_points(before.scans[i], after.scans[i]);
  }
}

}  // namespace
}  // namespace g4lidar::test
