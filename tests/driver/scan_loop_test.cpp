// SPDX-License-Identifier: MIT
// The rule of a loop over scans: it waits while the motor spins up and while a lost lidar is looked
// for, and ends where a scan that is due does not come.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;
using std::chrono::milliseconds;
using test::open_virtual;
using test::virtual_bench;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t second = 1'000 * ms;

const sim::fault second_unplug = sim::make_fault(sim::fault_kind::unplug, 4 * second, second);
const sim::fault long_unplug = sim::make_fault(sim::fault_kind::unplug, 4 * second, 60 * second);

/// A started lidar on its bench.
struct running {
  explicit running(const sim::device_options& device = {}, std::vector<sim::fault> faults = {},
                   bool reconnect = false)
      : bench(device, faults) {
    lidar_options options;
    options.reconnect = reconnect;
    opened.emplace(open_virtual(bench, options));
    EXPECT_TRUE(*opened);
    EXPECT_TRUE(lidar().start());
    started_ns = bench.now_ns;
  }

  [[nodiscard]] g4lidar::lidar& lidar() { return **opened; }
  [[nodiscard]] std::int64_t passed_ns() const { return bench.now_ns - started_ns; }
  /// The scans of a loop, until it ends or this many have come.
  int loop(milliseconds timeout, int most) {
    auto scans = lidar().scans(timeout);
    int count = 0;
    for ([[maybe_unused]] const scan& each : scans) {
      if (++count == most) break;
    }
    why = scans.why_ended();
    return count;
  }

  virtual_bench bench;
  std::optional<result<g4lidar::lidar>> opened;
  std::int64_t started_ns = 0;
  std::optional<error> why;
};

sim::device_options silent_for(std::int64_t silence_ns) {
  sim::device_options device;
  device.silence_ns = silence_ns;
  return device;
}

TEST(ScanLoop, HealthyDevice_NeverEndsForItsSpinUp) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    sim::device_options device;
    device.scanner.seed = seed;
    running run(device);
    EXPECT_EQ(run.loop(200ms, 10), 10) << "seed " << seed;
  }
}

TEST(ScanLoop, SpinUpLongerThanTheTimeout_IsWaitedFor) {
  for (const std::int64_t silence : {1500 * ms, 4 * second, 9 * second}) {
    running run(silent_for(silence));
    EXPECT_EQ(run.loop(100ms + 200ms, 5), 5) << silence;
    EXPECT_GE(run.passed_ns(), silence);
  }
}

TEST(ScanLoop, MotorThatNeverSpinsUp_EndsItAfterTenSeconds) {
  running run(silent_for(60 * second));
  EXPECT_EQ(run.loop(500ms, 1), 0);
  EXPECT_NEAR(static_cast<double>(run.passed_ns()), 10e9, 0.1e9);
  ASSERT_TRUE(run.why);
  EXPECT_EQ(*run.why, problem::timeout);
  EXPECT_EQ(run.why->detail(), error_detail::spinning_up);
  EXPECT_NE(run.why->message().find("the motor spins up"), std::string::npos);
}

TEST(ScanLoop, TimeoutAboveTenSeconds_IsWaitedForDuringSpinUp) {
  running run(silent_for(13 * second));
  EXPECT_EQ(run.lidar().wait_scan(12s).error(), problem::timeout);
  EXPECT_GE(run.passed_ns(), 12 * second);
}

TEST(ScanLoop, Unplug_IsWaitedForWithReconnecting) {
  for (const sim::fault& unplug : {second_unplug, long_unplug}) {
    running run({}, {unplug}, true);
    EXPECT_EQ(run.loop(300ms, 100), 100) << run.why->message();
    EXPECT_EQ(run.lidar().counts().reconnects, 1U);
    EXPECT_GT(run.passed_ns(), unplug.duration_ns + 10 * second);
  }
}

TEST(ScanLoop, SlowSpinUpAfterAReconnect_IsWaitedFor) {
  running run(silent_for(5 * second),
              {sim::make_fault(sim::fault_kind::unplug, 9 * second, second)}, true);
  EXPECT_EQ(run.loop(300ms, 60), 60);
  EXPECT_EQ(run.lidar().counts().reconnects, 1U);
}

TEST(ScanLoop, UnplugWithoutReconnecting_EndsIt) {
  running run({}, {second_unplug});
  EXPECT_GT(run.loop(300ms, 100), 10);
  ASSERT_TRUE(run.why);
  EXPECT_EQ(*run.why, problem::gone);
}

TEST(ScanLoop, ScanThatIsDue_EndsItAtTheTimeout) {
  running run({}, {sim::make_fault(sim::fault_kind::stall, 4 * second, 10 * second)});
  const int scans = run.loop(400ms, 100);
  EXPECT_GT(scans, 10);
  ASSERT_TRUE(run.why);
  EXPECT_EQ(*run.why, problem::timeout);
  EXPECT_EQ(run.why->detail(), error_detail::usual);
  // The stall begins 4 s after the device, and the last scan came at most a revolution before it.
  EXPECT_LT(run.bench.now_ns, 4 * second + 450 * ms);
  EXPECT_EQ(run.lidar().event_loop().scan_due_in(), 0ms);
}

TEST(ScanLoop, RestartOfADeviceThatRebooted_IsASpinUp) {
  sim::device_options device = silent_for(3 * second);
  device.boot_ns = 300 * ms;
  running run(device, {sim::make_fault(sim::fault_kind::reboot, 12 * second, second)});
  EXPECT_EQ(run.loop(1200ms, 130), 130);
}

TEST(ScanLoop, ScanThatWasInterruptedByARequest_IsASpinUp) {
  running run(silent_for(2 * second));
  auto scans = run.lidar().scans(250ms);
  int count = 0;
  for ([[maybe_unused]] const scan& each : scans) {
    if (++count == 20) break;
    if (count % 5 == 0) {
      EXPECT_TRUE(run.lidar().ask(requests::health(), while_scanning::stop_and_resume));
    }
  }
  EXPECT_EQ(count, 20);
}

TEST(ScanLoop, Wake_EndsItInEveryState) {
  running slow(silent_for(5 * second));
  slow.lidar().wake();
  EXPECT_EQ(slow.loop(500ms, 1), 0);
  EXPECT_EQ(*slow.why, problem::cancelled);
  EXPECT_EQ(slow.loop(500ms, 3), 3) << "the next loop continues";

  running lost({}, {long_unplug}, true);
  while (lost.lidar().try_scan(500ms)) {
  }
  lost.lidar().wake();
  EXPECT_EQ(lost.loop(500ms, 1), 0);
  EXPECT_EQ(*lost.why, problem::cancelled);
  EXPECT_LT(lost.bench.now_ns, 6 * second);
  EXPECT_EQ(lost.loop(500ms, 3), 3);
}

TEST(ScanLoop, CloseAndStopInItsBody_EndIt) {
  for (const bool closes : {true, false}) {
    running run;
    auto scans = run.lidar().scans(500ms);
    int count = 0;
    for ([[maybe_unused]] const scan& each : scans) {
      ++count;
      EXPECT_TRUE(closes ? run.lidar().close() : run.lidar().stop());
    }
    EXPECT_EQ(count, 1);
    EXPECT_EQ(*scans.why_ended(), closes ? problem::gone : problem::not_scanning);
  }
}

TEST(ScanLoop, EndOfAFile_EndsIt) {
  const std::string path = testing::TempDir() + "g4lidar-scan-loop.bin";
  sim::device simulated(sim::built_in_world());
  simulated.write(encode(command::start), 0);
  std::vector<std::uint8_t> buffer(100'000);
  simulated.read({}, 3 * second);
  const std::size_t count = simulated.read(buffer, 3 * second);
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  std::fwrite(buffer.data(), 1, count, file);
  std::fclose(file);
  auto lidar = lidar::open("file:" + path);
  ASSERT_TRUE(lidar);
  ASSERT_TRUE(lidar->start());
  auto scans = lidar->scans(100ms);
  int seen = 0;
  for ([[maybe_unused]] const scan& each : scans) ++seen;
  EXPECT_GT(seen, 10);
  EXPECT_EQ(*scans.why_ended(), problem::end_of_input);
  std::remove(path.c_str());
}

/// The end of a loop that waits in slices, and how many scans it gave.
std::pair<error, int> in_slices(running& run, milliseconds timeout, milliseconds slice) {
  scan_loop loop(timeout);
  for (int scans = 0;;) {
    const std::int64_t before_ns = run.bench.now_ns;
    const auto found = loop.wait(run.lidar(), slice);
    EXPECT_LE(run.bench.now_ns - before_ns, std::chrono::nanoseconds(slice).count() + 10 * ms);
    if (!found) return {found.error(), scans};
    if (*found) ++scans;
  }
}

TEST(ScanLoop, InSlices_EndsAsInOneWait) {
  const sim::fault stall = sim::make_fault(sim::fault_kind::stall, 4 * second, 10 * second);
  for (const milliseconds slice : {7ms, 150ms, 1000ms}) {
    running run({}, {stall});
    running whole({}, {stall});
    const auto [why, scans] = in_slices(run, 400ms, slice);
    EXPECT_EQ(why, problem::timeout);
    EXPECT_EQ(why.detail(), error_detail::usual);
    EXPECT_EQ(scans, whole.loop(400ms, 100)) << slice.count();
    const auto end_ns = static_cast<double>(whole.bench.now_ns);
    EXPECT_NEAR(static_cast<double>(run.bench.now_ns), end_ns, 20e6);
    running still(silent_for(60 * second));
    EXPECT_EQ(in_slices(still, 500ms, slice).first.detail(), error_detail::spinning_up);
    EXPECT_NEAR(static_cast<double>(still.passed_ns()), 10e9, 0.1e9);
    running restarted(silent_for(60 * second));  // the driver starts it again after 8 s
    EXPECT_EQ(in_slices(restarted, 12s, slice).first, problem::timeout);
    EXPECT_NEAR(static_cast<double>(restarted.passed_ns()), 12e9, 0.1e9);
    running lost({}, {second_unplug});
    EXPECT_EQ(in_slices(lost, 300ms, slice).first, problem::gone);
  }
}

TEST(ScanLoop, Left_IsTheLongestWait) {
  running run(silent_for(3 * second),
              {sim::make_fault(sim::fault_kind::unplug, 9 * second, 60 * second)}, true);
  scan_loop loop(300ms);
  EXPECT_GT(loop.left(run.lidar()), 9s) << "it spins up";
  auto found = loop.wait(run.lidar(), 5s);
  ASSERT_TRUE(found && *found);
  EXPECT_EQ(loop.left(run.lidar()), 300ms);
  found = loop.wait(run.lidar(), 50ms);
  ASSERT_TRUE(found && !*found) << "a revolution takes 140 ms";
  EXPECT_EQ(loop.left(run.lidar()), 250ms);
  run.lidar().wake();
  EXPECT_EQ(loop.wait(run.lidar(), 50ms).error(), problem::cancelled);
  EXPECT_LE(loop.left(run.lidar()), 250ms) << "the same wait";
  while (run.bench.now_ns < 10 * second) ASSERT_TRUE(loop.wait(run.lidar(), 100ms));
  EXPECT_EQ(loop.left(run.lidar()), milliseconds::max()) << "it is lost";
}

TEST(SingleCall, ReturnsByItsDeadline_AndNamesWhatIsAwaited) {
  running slow(silent_for(3 * second));
  const auto early = slow.lidar().try_scan(100ms);
  ASSERT_FALSE(early);
  EXPECT_EQ(early.error(), problem::timeout);
  EXPECT_EQ(early.error().detail(), error_detail::spinning_up);
  EXPECT_EQ(slow.lidar().next_points(100ms).error().detail(), error_detail::spinning_up);
  EXPECT_LT(slow.passed_ns(), 220 * ms);
  EXPECT_GT(slow.lidar().event_loop().scan_due_in(), 9s);
  EXPECT_LE(slow.lidar().event_loop().scan_due_in(), 10s);

  running lost({}, {long_unplug}, true);
  while (lost.lidar().try_scan(500ms)) {
  }
  const std::int64_t before_ns = lost.bench.now_ns;
  const auto away = lost.lidar().try_scan(2s);
  ASSERT_FALSE(away);
  EXPECT_LT(lost.bench.now_ns - before_ns, 2 * second + 10 * ms);
  EXPECT_EQ(away.error(), problem::timeout);
  EXPECT_EQ(away.error().detail(), error_detail::searching);
  EXPECT_NE(away.error().message().find("lost"), std::string::npos);
  EXPECT_EQ(away.error().message().find("unplug"), std::string::npos);
  EXPECT_EQ(lost.lidar().event_loop().scan_due_in(), milliseconds::max());
}

TEST(WhileScanning, ImpossibleValue_IsRefused) {
  for (const bool scans : {false, true}) {
    virtual_bench bench;
    auto lidar = open_virtual(bench);
    ASSERT_TRUE(lidar);
    if (scans) {
      ASSERT_TRUE(lidar->start());
    }
    const std::uint64_t writes = bench.writes;
    EXPECT_EQ(lidar->ask(requests::health(), while_scanning(9)).error(), problem::bad_option);
    EXPECT_EQ(lidar->set(scan_frequency::hz(9), while_scanning(2)).error(), problem::bad_option);
    EXPECT_EQ(lidar->ask(request{request_kind(99)}).error(), problem::bad_option);
    EXPECT_EQ(bench.writes, writes);
    EXPECT_EQ(lidar->is_scanning(), scans);
  }
}

}  // namespace
}  // namespace g4lidar
