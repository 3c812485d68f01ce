// SPDX-License-Identifier: MIT
// Options that a source cannot use are refused, whichever way it is opened.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/transport/source.hpp"
#include "recording/recorded_run.hpp"
#include "support/virtual_transport.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

struct option {
  std::string name;
  std::function<void(lidar_options&)> give;
};

const std::vector<option>& of_lidars() {
  static const std::vector<option> all{
      {"baud", [](auto& of) { of.baud = 115'200; }},
      {"listen_only", [](auto& of) { of.listen_only = true; }},
      {"leave_dtr", [](auto& of) { of.leave_dtr = true; }},
      {"sample_rate", [](auto& of) { of.sample_rate = sample_rate::khz_8; }},
      {"frequency", [](auto& of) { of.frequency = scan_frequency::hz(10); }},
      {"direction", [](auto& of) { of.direction = motor_direction::clockwise; }},
      {"constant", [](auto& of) { of.constant = constant_frequency::on; }},
      {"idle", [](auto& of) { of.idle = low_power::off; }},
      {"protection", [](auto& of) { of.protection = power_down_protection::on; }},
      {"reconnect", [](auto& of) { of.reconnect = true; }},
      {"longest_backoff", [](auto& of) { of.tuning.longest_backoff = 10ms; }},
      {"answer_time", [](auto& of) { of.tuning.answer_time = 100ms; }},
      {"stall_time", [](auto& of) { of.tuning.stall_time = 500ms; }},
      {"pace", [](auto& of) { of.tuning.pace = read_pace::packets; }},
  };
  return all;
}
const std::vector<option>& of_files() {
  static const std::vector<option> all{
      {"speed", [](auto& of) { of.playback.speed = 1; }},
      {"loop", [](auto& of) { of.playback.loop = true; }},
      {"begin", [](auto& of) { of.playback.from_ns = 1'000'000; }},
      {"end", [](auto& of) { of.playback.to_ns = 1'000'000'000; }},
  };
  return all;
}
const option of_ports{"probe_all_ports", [](auto& of) { of.probe_all_ports = true; }};
const option of_raw_files{"raw_sample_rate_hz", [](auto& of) { of.raw_sample_rate_hz = 9000; }};
const std::vector<option>& of_all() {
  static const std::vector<option> all{
      {"model", [](auto& of) { of.model = &g4_model; }},
      {"insist_on_model", [](auto& of) { of.insist_on_model = true; }},
      {"partial_scans", [](auto& of) { of.partial_scans = true; }},
      {"zero_angle", [](auto& of) { of.zero_angle = zero_angle{.cdeg = 100}; }},
      {"batch", [](auto& of) { of.tuning.batch = 5ms; }},
      {"transport_delay", [](auto& of) { of.tuning.transport_delay = 1ms; }},
      {"device_wait", [](auto& of) { of.device_wait = 1ms; }},
  };
  return all;
}

class SourceOptions : public ::testing::Test {
 protected:
  void SetUp() override {
    auto writer = recording_writer::create(recording_.text());
    ASSERT_TRUE(writer);
    record_device(*writer, 2'000'000'000);
    ASSERT_TRUE(writer->close());
    const sim::device_options options;
    sim::device device(sim::built_in_world(), options);
    device.write(encode(command::start), 0);
    std::vector<std::uint8_t> bytes(30'000);
    bytes.resize(device.read(bytes, 2'000'000'000));
    std::ofstream(raw_.text(), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    ASSERT_EQ(::mkfifo(pipe_.text().c_str(), 0600), 0);
  }

  /// Each of them is refused by name, before anything is opened, and taken back by usable_options().
  void expect_refused(const std::string& device, const std::vector<option>& all) {
    for (const option& each : all) {
      lidar_options given{.device = device};
      each.give(given);
      const auto opened = lidar::open(given);
      ASSERT_FALSE(opened) << each.name << " for " << device;
      EXPECT_EQ(opened.error(), problem::bad_option) << each.name << " for " << device;
      EXPECT_EQ(opened.error().detail(), error_detail::other_source) << each.name;
      EXPECT_EQ(opened.error().subject().substr(0, each.name.size()), each.name) << each.name;
      EXPECT_FALSE(connector_for(given)) << each.name;
      ASSERT_TRUE(problem_with_source(given)) << each.name;
      EXPECT_FALSE(problem_with_source(usable_options(given))) << each.name;
    }
  }
  void expect_used(const std::string& device, const std::vector<option>& all) {
    for (const option& each : all) {
      lidar_options given{.device = device};
      each.give(given);
      EXPECT_FALSE(problem_with_source(given)) << each.name << " for " << device;
    }
  }

  temporary_path recording_;
  temporary_path raw_{".bin"};
  temporary_path pipe_{".fifo"};
};

TEST_F(SourceOptions, OfALidar) {
  for (const std::string name : {"sim:", "/dev/ttyNothing", "tcp:127.0.0.1:9", ""}) {
    expect_refused(name, of_files());
    expect_refused(name, {of_raw_files});
    expect_used(name, of_lidars());
    expect_used(name, of_all());
  }
  for (const std::string name : {"/dev/ttyNothing", "serial:2021101000070073", "usb:1-1.4", ""})
    expect_used(name, {of_ports});
  for (const std::string name : {"sim:", "tcp:127.0.0.1:9"}) expect_refused(name, {of_ports});
}

TEST_F(SourceOptions, OfARecording) {
  expect_refused(recording_.text(), {of_ports});
  expect_refused(recording_.text(), of_lidars());
  expect_refused(recording_.text(), {of_raw_files});
  expect_used(recording_.text(), of_files());
  expect_used(recording_.text(), of_all());
}

TEST_F(SourceOptions, OfAFileOfRawBytes) {
  for (const std::string& name :
       {raw_.text(), "file:" + raw_.text(), std::string("file:nothing.bin")}) {
    expect_refused(name, of_lidars());
    expect_refused(name, {of_ports});
    expect_used(name, of_files());
    expect_used(name, {of_raw_files});
    expect_used(name, of_all());
  }
}

TEST_F(SourceOptions, OfAPipe) {
  expect_refused(pipe_.text(), of_lidars());
  expect_refused(pipe_.text(), {of_ports});
  expect_refused(pipe_.text(), of_files());
  expect_used(pipe_.text(), {of_raw_files});
  expect_used(pipe_.text(), of_all());
}

TEST_F(SourceOptions, OfAConnectorOfTheProgram) {
  for (const option& each : of_files()) {
    virtual_bench bench;
    lidar_options given;
    each.give(given);
    EXPECT_EQ(open_virtual(bench, given).error(), problem::bad_option) << each.name;
  }
  for (const option& each : of_lidars()) {
    auto from = replay::open(recording_.text());
    ASSERT_TRUE(from);
    lidar_options given;
    each.give(given);
    EXPECT_EQ(lidar::open(*std::move(from), given).error(), problem::bad_option) << each.name;
  }
}

TEST_F(SourceOptions, UsableOnes_KeepTheOthers) {
  lidar_options given{.device = recording_.text(), .reconnect = true, .partial_scans = true};
  given.playback.speed = 2;
  const lidar_options left = usable_options(given);
  EXPECT_FALSE(left.reconnect);
  EXPECT_TRUE(left.partial_scans);
  EXPECT_EQ(left.playback.speed, 2);
  EXPECT_TRUE(lidar::open(left));
}

}  // namespace
}  // namespace g4lidar::test
