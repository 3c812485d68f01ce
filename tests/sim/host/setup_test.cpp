// SPDX-License-Identifier: MIT
// Texts of simulated lidars, and the places where they are served.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <variant>

#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/setup.hpp"
#include "support/patience.hpp"

namespace {

using namespace g4lidar;
using namespace std::chrono_literals;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

sim::setup read(std::string_view source) {
  const auto found = sim::parse_setup(source);
  if (const auto* wrong = std::get_if<sim::setup_error>(&found)) {
    ADD_FAILURE() << source << ": " << wrong->message;
    return {};
  }
  return std::get<sim::setup>(found);
}

std::string refusal(std::string_view source) {
  const auto found = sim::parse_setup(source);
  const auto* wrong = std::get_if<sim::setup_error>(&found);
  return wrong == nullptr ? "nothing" : wrong->message;
}

class SimSetup : public testing::Test {
 protected:
  SimSetup() {
    std::string name = fs::temp_directory_path() / "g4lidar-setup-XXXXXX";
    directory_ = ::mkdtemp(name.data());
  }
  ~SimSetup() override { fs::remove_all(directory_); }

  std::string written(const std::string& text) {
    std::ofstream(directory_ / "room.txt") << text;
    return directory_ / "room.txt";
  }
  fs::path directory_;
};

TEST_F(SimSetup, TheShortestText_IsAHealthyDevice) {
  EXPECT_TRUE(sim::is_simulated("sim:"));
  EXPECT_FALSE(sim::is_simulated("/dev/ttyUSB0"));
  for (const char* const source : {"sim:", "sim:?"}) {
    const sim::setup found = read(source);
    EXPECT_EQ(found.world_file, "");
    EXPECT_EQ(found.device.scanner.seed, 1U);
    EXPECT_EQ(found.device.info.serial_number(), "2021101000070073");
    EXPECT_TRUE(found.faults.empty());
  }
}

TEST_F(SimSetup, EveryKindOfValue) {
  const sim::setup found = read(
      "sim:?world=a%20room%3D1.txt&seed=18446744073709551615&serial=0000000000000042&model_id=255"
      "&fault=unplug@5s%2B2s&fault=flip&boot_text=false&boots_at_start=true&baud=115200"
      "&header_ns=1.5s&silence_ns=2&standstill_ns=0");
  EXPECT_EQ(found.world_file, "a room=1.txt");
  EXPECT_EQ(found.device.scanner.seed, 18'446'744'073'709'551'615U);
  EXPECT_EQ(found.device.info.serial_number(), "0000000000000042");
  EXPECT_EQ(found.device.info.model, 255);
  ASSERT_EQ(found.faults.size(), 2U);
  EXPECT_EQ(found.faults[0].kind, sim::fault_kind::unplug);
  EXPECT_EQ(found.faults[0].begin_ns, 5'000'000'000);
  EXPECT_EQ(found.faults[0].duration_ns, 2'000'000'000);
  EXPECT_EQ(found.faults[1].kind, sim::fault_kind::flip);
  EXPECT_FALSE(found.device.boot_text);
  EXPECT_TRUE(found.device.boots_at_start);
  EXPECT_EQ(found.device.baud, 115'200U);
  EXPECT_EQ(found.device.header_ns, 1'500'000'000);
  EXPECT_EQ(found.device.silence_ns, 2'000'000'000) << "a number alone is seconds";
  EXPECT_EQ(found.device.standstill_ns, 0);
}

TEST_F(SimSetup, AModelByItsName) {
  const sim::device_options x2 = read("sim:?model=x2").device;
  EXPECT_TRUE(x2.one_way);
  EXPECT_EQ(x2.baud, 115'200U);
  EXPECT_EQ(x2.info.model, 4);
  const sim::setup changed =
      read("sim:?baud=9600&ct_crc=true&model_id=9&one_way=false&seed=3&model=x2");
  EXPECT_EQ(changed.device.baud, 9600U) << "whatever the order";
  EXPECT_TRUE(changed.device.ct_crc);
  EXPECT_EQ(changed.device.info.model, 9);
  EXPECT_FALSE(changed.device.one_way);
  EXPECT_EQ(changed.device.scanner.seed, 3U);
  const auto code = [](const char* source) { return read(source).device.scanner.format.code; };
  EXPECT_EQ(code("sim:?model=s2-pro").size(), 2U);
  EXPECT_EQ(code("sim:?model=s2-pro-intensity").size(), 3U);
  EXPECT_EQ(code("sim:?model=s2-pro&other_layout=true").size(), 3U);
  EXPECT_EQ(code("sim:?model=tg30").units_per_mm, 1);
  EXPECT_EQ(code("sim:?model=tg30&firmware=1.2").units_per_mm, 2);
  EXPECT_EQ(code("sim:?model=tg30&firmware=1.3").units_per_mm, 1);
  EXPECT_EQ(code("sim:").units_per_mm, 4);
  EXPECT_THAT(refusal("sim:?model=x5"), StartsWith("model: 'x5' is not one of g4, g4-pro, "));
  EXPECT_EQ(refusal("sim:?model=x4&other_layout=true"),
            "model: 'x4' has one layout of samples only");
}

TEST_F(SimSetup, AnotherModel_IsOpenedAtItsRate) {
  for (const std::string word : {"x4", "x4-pro", "tg15"}) {
    lidar_options options;
    options.device = "sim:?model=" + word;
    const auto opened = lidar::open(options);
    EXPECT_TRUE(opened) << word << ": " << opened.error().message();
  }
}

TEST_F(SimSetup, OpenQuestionsOfTheProtocol) {
  const sim::device_options ours = read("sim:").device;
  EXPECT_EQ(ours.counter_clockwise, sim::turning::mirrored);
  const auto direction = [](const char* source) { return read(source).device.counter_clockwise; };
  EXPECT_EQ(direction("sim:?counter_clockwise=clockwise"), sim::turning::clockwise);
  EXPECT_EQ(direction("sim:?counter_clockwise=mirrored"), sim::turning::mirrored);
  EXPECT_EQ(direction("sim:?counter_clockwise=falling"), sim::turning::falling);
  const auto limit = [](const char* source) { return read(source).device.frequency_at_limit; };
  EXPECT_EQ(limit("sim:?frequency_at_limit=clamp"), sim::at_limit::clamp);
  EXPECT_EQ(limit("sim:?frequency_at_limit=refuse"), sim::at_limit::refuse);
  const auto disturbed = [](const char* source) { return read(source).device.while_scanning; };
  EXPECT_EQ(disturbed("sim:?while_scanning=mid_packet"), sim::disturbance::mid_packet);
  EXPECT_EQ(disturbed("sim:?while_scanning=between"), sim::disturbance::between);
  EXPECT_EQ(disturbed("sim:?while_scanning=drops"), sim::disturbance::drops);
  EXPECT_EQ(disturbed("sim:?while_scanning=ignored"), sim::disturbance::ignored);
  EXPECT_EQ(read("sim:?highest_frequency_chz=1030").device.highest_frequency_chz, 1030);
  const device_information info = read("sim:?firmware=2.17").device.info;
  EXPECT_EQ(info.firmware_major, 2);
  EXPECT_EQ(info.firmware_minor, 17);
}

TEST_F(SimSetup, StoredSettings) {
  const auto initial = [](const char* source) { return read(source).device.initial; };
  EXPECT_EQ(initial("sim:?initial_idle_power=off").idle_power, low_power::off);
  EXPECT_EQ(initial("sim:?initial_idle_power=on").idle_power, low_power::on);
  EXPECT_EQ(initial("sim:?initial_direction=counter_clockwise").direction,
            motor_direction::counter_clockwise);
  EXPECT_EQ(initial("sim:?initial_direction=clockwise").direction, motor_direction::clockwise);
  EXPECT_EQ(initial("sim:?initial_constancy=off").constancy, constant_frequency::off);
  EXPECT_EQ(initial("sim:?initial_constancy=on").constancy, constant_frequency::on);
  EXPECT_EQ(initial("sim:?initial_protection=on").protection, power_down_protection::on);
  EXPECT_EQ(initial("sim:?initial_protection=off").protection, power_down_protection::off);
}

TEST_F(SimSetup, TheOrderOfTheOptionsIsFree) {
  for (const char* const source :
       {"sim:?batch_min_ns=5ms&batch_max_ns=10ms", "sim:?batch_max_ns=10ms&batch_min_ns=5ms"}) {
    EXPECT_EQ(read(source).device.batch_min_ns, 5'000'000);
    EXPECT_EQ(read(source).device.batch_max_ns, 10'000'000);
  }
}

TEST_F(SimSetup, InvalidTexts_AreRefused) {
  EXPECT_THAT(refusal("/dev/ttyUSB0"), HasSubstr("does not begin with sim:"));
  EXPECT_THAT(refusal("sim:?colour=red"),
              StartsWith("'colour' is not one of fault, firmware, model, "));
  // An error has room for 159 characters, and its subject for "sim: ()", too.
  EXPECT_THAT(refusal("sim:colour"), EndsWith("world, or of those in docs/sim_device.md"));
  EXPECT_LT(refusal("sim:colour").size(), 150U);
  EXPECT_THAT(refusal("sim:?&"), StartsWith("'' is not one of fault"));
  EXPECT_EQ(refusal("sim:?seed=-1"), "seed: '-1' is not in the range 0 to 18446744073709551615");
  EXPECT_EQ(refusal("sim:?seed="), "seed: '' is not in the range 0 to 18446744073709551615");
  EXPECT_EQ(refusal("sim:?model_id=256"), "model_id: '256' is not in the range 0 to 255");
  EXPECT_EQ(refusal("sim:?baud=9600x"), "baud: '9600x' is not in the range 0 to 4294967295");
  EXPECT_EQ(refusal("sim:?boot_text"), "boot_text: '' is not one of false, true");
  EXPECT_EQ(refusal("sim:?while_scanning=never"),
            "while_scanning: 'never' is not one of mid_packet, between, drops, ignored");
  EXPECT_EQ(refusal("sim:?initial_protection=true"),
            "initial_protection: 'true' is not one of on, off");
  EXPECT_EQ(refusal("sim:?highest_frequency_chz=70000"),
            "highest_frequency_chz: '70000' is not in the range 0 to 65535");
  EXPECT_THAT(refusal("sim:?highest_frequency_chz=699"), HasSubstr("from the device's own"));
  for (const char* const version : {"", "3", "3.", ".2", "3.256", "3.2.1", "three"}) {
    EXPECT_EQ(refusal("sim:?firmware=" + std::string(version)),
              "'" + std::string(version) + "' is not a firmware version such as 3.2");
  }
  EXPECT_THAT(refusal("sim:?header_ns=2parsecs"),
              StartsWith("header_ns: '2parsecs' is not a time such as"));
  EXPECT_THAT(refusal("sim:?header_ns="), StartsWith("header_ns: '' is not a time such as"));
  EXPECT_THAT(refusal("sim:?header_ns=2min"), HasSubstr("must take 0 to 60 s"));
  EXPECT_THAT(refusal("sim:?serial=123"), HasSubstr("a serial number has 16 decimal digits"));
  EXPECT_THAT(refusal("sim:?serial=123456789012345x"), HasSubstr("has 16 decimal digits"));
  EXPECT_THAT(refusal("sim:?fault=unplug@5"), StartsWith("unplug@5: '5' is no time"));
}

TEST_F(SimSetup, SeveralDevicesDifferInSeedAndSerial) {
  sim::setup first = read("sim:?seed=7&serial=0000000000000042&model_id=4");
  const auto made = sim::several(first.device, 4, {"1234567890123456", "0000000000000043"});
  ASSERT_EQ(made.size(), 4U);
  EXPECT_EQ(made[0].info.serial_number(), "1234567890123456");
  EXPECT_EQ(made[1].info.serial_number(), "0000000000000043");
  EXPECT_EQ(made[2].info.serial_number(), "0000000000000042");
  EXPECT_EQ(made[3].info.serial_number(), "0000000000000044") << "43 is in use";
  EXPECT_EQ(made[3].scanner.seed, 10U);
  EXPECT_EQ(made[3].info.model, 4);
  first.device.info.serial_digits.fill('9');
  EXPECT_EQ(sim::several(first.device, 2, {})[1].info.serial_number(), "0000000000000000");
}

TEST_F(SimSetup, WorldFiles) {
  const auto error_of = [](const std::string& file) {
    const auto found = sim::load_world(file);
    const auto* wrong = std::get_if<sim::world_error>(&found);
    return wrong == nullptr ? "nothing" : std::to_string(wrong->line) + ": " + wrong->message;
  };
  EXPECT_GT(std::get<sim::world>(sim::load_world("")).walls.size(), 10U);
  const auto found = sim::load_world(written("lidar 0 0 90\nwall -2 1 2 1\n"));
  ASSERT_EQ(std::get<sim::world>(found).walls.size(), 1U);
  EXPECT_EQ(std::get<sim::world>(found).lidar.heading_deg, 90.0);
  EXPECT_THAT(error_of(written("lidar 0 0 0\nwindow 3 3\n")), StartsWith("2: 'window' is unknown"));
  EXPECT_EQ(error_of(directory_ / "none"), "0: it cannot be read: No such file or directory");
  EXPECT_EQ(error_of(directory_), "0: it is a directory");
  EXPECT_EQ(error_of("/dev/zero"), "0: it is a pipe or a device, not a file");
}

TEST_F(SimSetup, PathFiles) {
  sim::world world = sim::built_in_world();
  const auto error_of = [&](const std::string& file) {
    const auto wrong = sim::load_path(world, file);
    return wrong ? std::to_string(wrong->line) + ": " + wrong->message : "nothing";
  };
  EXPECT_EQ(error_of(written("drive forward 2\n")), "nothing");
  EXPECT_NEAR(world.path.back().robot.at.y_m, 2.0, 1e-9);
  EXPECT_EQ(error_of(written("pose 1 2 3 4\n")), "nothing");
  EXPECT_EQ(world.lidar, (sim::pose{2.0, 3.0, 4.0}));
  EXPECT_THAT(error_of(written("\nwall 1 1 2 2\n")), StartsWith("2: 'wall' is unknown"));
  EXPECT_EQ(error_of(written("")), "0: there is no line 'pose' and no line 'drive'");
  EXPECT_EQ(error_of(directory_ / "none"), "0: it cannot be read: No such file or directory");
  EXPECT_EQ(world.lidar, (sim::pose{2.0, 3.0, 4.0})) << "changed by an error";
  const auto setup = sim::parse_setup("sim:?path=way.txt");
  EXPECT_EQ(std::get<sim::setup>(setup).path_file, "way.txt");
}

TEST_F(SimSetup, RegisteredLinksAreInTheDirectoryOfTheVariable) {
  ::unsetenv("G4LIDAR_SIM_DIR");
  EXPECT_EQ(sim::registered_link("1234567890123456"), "");
  const std::string place = directory_ / "of" / "ports";
  ::setenv("G4LIDAR_SIM_DIR", place.c_str(), 1);
  EXPECT_EQ(sim::registered_link("1234567890123456"), place + "/g4-1234567890123456");
  EXPECT_TRUE(fs::is_directory(place));
  ::unsetenv("G4LIDAR_SIM_DIR");
}

TEST_F(SimSetup, ADeviceServedAlone_KeepsItsPath) {
  ::setenv("TMPDIR", directory_.c_str(), 1);
  auto served = sim::serve_alone(sim::device(sim::built_in_world()));
  ::unsetenv("TMPDIR");
  ASSERT_TRUE(served) << served.error().message();
  const std::string path = (*served)->path();
  EXPECT_THAT(path, StartsWith(directory_.native()));
  const auto is_there = [&path](bool wanted) {
    return test::comes_true([&] { return fs::exists(path) == wanted; }) == wanted;
  };
  EXPECT_TRUE(is_there(true));
  (*served)->with([](sim::device& simulated, std::int64_t now_ns) { simulated.unplug(now_ns); });
  EXPECT_FALSE(is_there(false));
  (*served)->with([](sim::device& simulated, std::int64_t now_ns) { simulated.replug(now_ns); });
  EXPECT_TRUE(is_there(true));
  EXPECT_EQ((*served)->path(), path);
  served->reset();
  EXPECT_TRUE(fs::is_empty(directory_));
}

TEST_F(SimSetup, WithoutAPlaceForTheLink_ServingFails) {
  ::setenv("TMPDIR", (directory_ / "none").c_str(), 1);
  const auto served = sim::serve_alone(sim::device(sim::built_in_world()));
  ::unsetenv("TMPDIR");
  ASSERT_FALSE(served);
  EXPECT_EQ(served.error(), problem::system);
}

}  // namespace
