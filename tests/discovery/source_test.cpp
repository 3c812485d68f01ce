// SPDX-License-Identifier: MIT
// What the name of a lidar means, and lidar::open() with each kind of name.
#include "g4lidar/transport/source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/setup.hpp"
#include "support/patience.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class Source : public testing::Test {
 protected:
  Source() {
    std::string name = fs::temp_directory_path() / "g4lidar-source-XXXXXX";
    directory_ = ::mkdtemp(name.data());
  }
  ~Source() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return directory_ / name; }
  std::string written(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  /// The bytes of a scanning G4, for so long.
  std::string recorded_bytes(std::chrono::nanoseconds longest) const {
    sim::device device(sim::built_in_world());
    device.write(bytes(start_), 0);
    std::string all;
    std::array<std::uint8_t, 4096> some{};
    for (std::int64_t now_ns = 0; now_ns < longest.count(); now_ns += 1'000'000) {
      const std::size_t count = device.read(some, now_ns);
      all.append(reinterpret_cast<const char*>(some.data()), count);
    }
    return all;
  }

  static constexpr std::array<std::uint8_t, 2> start_{0xA5, 0x60};
  fs::path directory_;
};

TEST_F(Source, NameOfADeviceMayNameItsModel) {
  for (const std::string device : {"/dev/ttyUSB0", "usb:1-1.4", "tcp:host:4000", "serial:1"}) {
    const std::string name = device + "?model=x4";
    EXPECT_EQ(kind_of_source(name), source_kind::device);
    EXPECT_EQ(path_of_source(name), device);
    EXPECT_EQ(model_in_source(name).value()->word, "x4");
    EXPECT_EQ(model_of_source({.device = name}).value()->word, "x4");
    EXPECT_EQ(model_in_source(device).value(), nullptr);
    EXPECT_EQ(model_of_source({.device = device}).value(), nullptr);
  }
  EXPECT_EQ(model_in_source("/dev/ttyUSB0?model=x9").error().code(), problem::bad_option);
  EXPECT_EQ(path_of_source("sim:?model=x4"), "sim:?model=x4");
  const auto both = connector_for({.device = "/dev/ttyUSB0?model=x4", .model = model_named("x2")});
  ASSERT_FALSE(both);
  EXPECT_THAT(both.error().message(), HasSubstr("model: x2, and the name states x4"));
}

TEST_F(Source, Kind_IsThatOfTheFormOrOfWhatIsThere) {
  const std::string mcap = written("walk.mcap", "\x89MCAP0\r\n");
  const std::string raw = written("port.raw", "\xAA\x55");
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const std::pair<std::string, source_kind> all[] = {
      {"", source_kind::device},
      {"/dev/null", source_kind::device},
      {path("missing"), source_kind::device},
      {"serial:2021101000070073", source_kind::device},
      {"usb:1-1.4", source_kind::device},
      {"tcp:localhost:4000", source_kind::device},
      {mcap, source_kind::recording},
      {"file:" + mcap, source_kind::recording},
      {raw, source_kind::raw_bytes},
      {"file:" + raw, source_kind::raw_bytes},
      {"file:" + path("missing"), source_kind::raw_bytes},
      {path("pipe"), source_kind::raw_bytes},
      {directory_.string(), source_kind::raw_bytes},
      {"-", source_kind::raw_bytes},
      {"sim:", source_kind::simulated},
      {"sim:?seed=7", source_kind::simulated},
  };
  for (const auto& [name, kind] : all) EXPECT_EQ(kind_of_source(name), kind) << name;
  EXPECT_EQ(path_of_source("file:" + raw), raw);
  EXPECT_EQ(path_of_source(raw), raw);
}

TEST_F(Source, Sim_IsASimulatedLidarThatScans) {
  auto lidar = lidar::open("sim:?seed=7&serial=1234567890123456&standstill_ns=10ms");
  ASSERT_TRUE(lidar) << lidar.error().message();
  EXPECT_EQ(lidar->information().serial_number(), "1234567890123456");
  ASSERT_TRUE(lidar->start());
  const auto scan = lidar->wait_scan(patience);
  ASSERT_TRUE(scan) << scan.error().message();
  EXPECT_GT(scan->size(), 500U);
}

TEST_F(Source, Sim_SurvivesAnUnplugWithReconnecting) {
  auto lidar = lidar::open("sim:?fault=unplug@300ms+200ms&standstill_ns=10ms", {.reconnect = true});
  ASSERT_TRUE(lidar) << lidar.error().message();
  // On a busy machine it is unplugged before it has started.
  EXPECT_TRUE(comes_true([&] { return lidar->start().has_value(); }));
  EXPECT_TRUE(comes_true([&] {
    static_cast<void>(lidar->try_scan(100ms));
    return lidar->counts().reconnects == 1 && lidar->counts().scans > 0;
  }));
}

TEST_F(Source, Sim_WithAWrongSetup_IsRefusedWithTheReason) {
  const auto refused = [](const std::string& name) {
    const auto found = lidar::open(name);
    EXPECT_FALSE(found);
    return found ? error(task::opening, problem::timeout) : found.error();
  };
  const error seed = refused("sim:?seed=x");
  EXPECT_EQ(seed, problem::bad_option);
  EXPECT_THAT(seed.message(), AllOf(HasSubstr("seed: 'x' is not"), HasSubstr("docs/sim.md")));
  EXPECT_EQ(refused("sim:?sed=7"), problem::bad_option);
  const error line = refused("sim:?world=" + written("room.txt", "wall 0 0 1 0\nwall 1\n"));
  EXPECT_EQ(line, problem::bad_file);
  EXPECT_THAT(line.message(), HasSubstr("room.txt, line 2 ("));
  EXPECT_EQ(refused("sim:?world=" + path("missing")), problem::bad_file);
}

TEST_F(Source, SimulationOf_IsThatOfTheConnector) {
  const std::string way = written("way.txt", "pose 0 0 0 0\npose 10 1 0 0\n");
  const auto from = connector_for({.device = "sim:?path=" + way});
  ASSERT_TRUE(from) << from.error().message();
  const sim::simulated_source* const found = simulation_of(**from);
  ASSERT_NE(found, nullptr);
  EXPECT_TRUE(found->robot);
  EXPECT_TRUE(fs::exists(found->port->path()));
  const std::chrono::nanoseconds now = std::chrono::steady_clock::now().time_since_epoch();
  EXPECT_LE(found->begin_ns, now.count());
  const auto other = connector_for({.device = "tcp:localhost:4000"});
  ASSERT_TRUE(other);
  EXPECT_EQ(simulation_of(**other), nullptr);
}

TEST_F(Source, RawBytes_GiveTheirScans_WithTimesOfTheirSampleRate) {
  const std::string raw = written("port.raw", recorded_bytes(3s));
  auto lidar = lidar::open(raw, {.raw_sample_rate_hz = 9000});
  ASSERT_TRUE(lidar) << lidar.error().message();
  ASSERT_TRUE(lidar->start());
  int scans = 0;
  auto all = lidar->scans(patience);
  for (const scan& each : all) {
    // At 9 kHz the numbers of samples are times.
    EXPECT_NEAR(static_cast<double>(each.end_ns() - each.time_ns()) * 9e-6,
                static_cast<double>(each.size()), 4.0);
    ++scans;
  }
  EXPECT_EQ(all.why_ended(), problem::end_of_input);
  EXPECT_GE(scans, 5);
}

TEST_F(Source, DeviceWait_FindsADeviceThatIsPluggedInLater) {
  const std::string link = path("later");
  std::atomic<bool> is_found{false};
  std::jthread plugging([&](const std::stop_token&) {
    std::this_thread::sleep_for(700ms);
    auto port = sim::background_pty::open(sim::device(sim::built_in_world()), link);
    if (port) static_cast<void>(comes_true([&] { return is_found.load(); }));
  });
  const auto found = lidar::open(link, {.device_wait = patience});
  is_found = true;
  EXPECT_TRUE(found) << found.error().message();
}

TEST_F(Source, DeviceWait_EndsWithItsTimeOrIfItIsCancelled) {
  EXPECT_EQ(lidar::open(path("never")).error(), problem::no_port);
  EXPECT_EQ(lidar::open(path("never"), {.device_wait = 600ms}).error(), problem::no_port);
  int calls = 0;
  lidar_options how{.device_wait = std::chrono::milliseconds::max()};
  how.is_cancelled = [&] { return ++calls > 5; };
  EXPECT_EQ(lidar::open(path("never"), how).error(), problem::cancelled);
  EXPECT_GT(calls, 5);
  how.is_cancelled = {};
  EXPECT_EQ(lidar::open("sim:?seed=x", how).error(), problem::bad_option)
      << "no device can mend it";
}

TEST_F(Source, Wrap_GetsTheConnectorOfEachAttempt_AndItsErrorEndsIt) {
  int attempts = 0;
  lidar_options how{.device = path("never"), .device_wait = 1200ms};
  how.wrap = [&](std::unique_ptr<connector> from) {
    ++attempts;
    return result<std::unique_ptr<connector>>(std::move(from));
  };
  EXPECT_EQ(lidar::open(how).error(), problem::no_port);
  EXPECT_GE(attempts, 2);
  how.wrap = [](std::unique_ptr<connector>) -> result<std::unique_ptr<connector>> {
    return failure(task::opening, problem::bad_file, "full");
  };
  EXPECT_EQ(lidar::open(how).error(), problem::bad_file);
}

}  // namespace
}  // namespace g4lidar::test
