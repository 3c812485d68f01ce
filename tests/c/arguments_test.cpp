// SPDX-License-Identifier: MIT
// Mistakes of callers: an error, never a crash. Calls with NULL handles are only here.
#include <array>
#include <cstring>
#include <string>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;

TEST(CArguments, NullIsAnError) {
  g4lidar_error why;
  const auto is_refused = [&](int code) {
    const bool is_filled = why.code == code && std::strlen(why.message) > 0;
    why = {};
    return code == G4LIDAR_BAD_ARGUMENT && is_filled;
  };
  const g4lidar_scan* scan = nullptr;
  const g4lidar_point* points = nullptr;
  const g4lidar_item* item = nullptr;
  std::size_t count = 0;
  std::int32_t value = 0;
  g4lidar_health health;
  EXPECT_TRUE(is_refused(g4lidar_open("", nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_open_with(nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_start(nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_stop(nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_close(nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_process(nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_try_scan(nullptr, 0, &scan, &why)));
  EXPECT_TRUE(is_refused(g4lidar_wait_scan(nullptr, 0, &scan, &why)));
  EXPECT_TRUE(is_refused(g4lidar_next_points(nullptr, 0, &points, &count, &why)));
  EXPECT_TRUE(is_refused(g4lidar_get(nullptr, G4LIDAR_LOW_POWER, 0, &value, &why)));
  EXPECT_TRUE(is_refused(g4lidar_set(nullptr, G4LIDAR_LOW_POWER, 1, 0, &value, &why)));
  EXPECT_TRUE(is_refused(g4lidar_step_frequency(nullptr, 10, 0, &value, &why)));
  EXPECT_TRUE(is_refused(g4lidar_restart(nullptr, 0, &why)));
  EXPECT_TRUE(is_refused(g4lidar_get_health(nullptr, 0, &health, &why)));
  EXPECT_TRUE(is_refused(g4lidar_open_recording(nullptr, nullptr, nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_seek(nullptr, 0, &why)));
  EXPECT_TRUE(is_refused(g4lidar_pause(nullptr, true, &why)));
  EXPECT_TRUE(is_refused(g4lidar_set_speed(nullptr, 1.0, &why)));
  EXPECT_TRUE(is_refused(g4lidar_set_loop(nullptr, true, &why)));
  EXPECT_TRUE(is_refused(g4lidar_background_start(nullptr, false, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_background_next_scan(nullptr, 0, &scan, &why)));
  EXPECT_TRUE(is_refused(g4lidar_background_set_speed(nullptr, 1.0, &why)));
  EXPECT_TRUE(is_refused(g4lidar_recorder_create(nullptr, nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_recorder_flush(nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_recorder_close(nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_recorder_take_error(nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_reader_open(nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_reader_open_with(nullptr, nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_reader_next(nullptr, &item, &why)));
  EXPECT_TRUE(is_refused(g4lidar_reader_seek(nullptr, 0, &why)));
  EXPECT_TRUE(is_refused(g4lidar_simulator_create(nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_open_simulated(nullptr, nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_list_ports(nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_find_lidars(nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_select_port(nullptr, nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_port_monitor_open(nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_mask_parse(nullptr, nullptr, &why)));
  EXPECT_TRUE(is_refused(g4lidar_estimator_create(nullptr, &why)));
  // Without an error struct, too.
  EXPECT_EQ(g4lidar_open("", nullptr, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_try_scan(nullptr, 0, nullptr, nullptr), G4LIDAR_BAD_ARGUMENT);
}

TEST(CArguments, NullIsAnErrorOfFunctionsWithoutErrorStruct) {
  std::size_t count = 0;
  bool plugged = false;
  EXPECT_EQ(g4lidar_next_event(nullptr, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_background_next_event(nullptr, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_background_rest(nullptr, true), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_background_pause(nullptr, true), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_background_seek(nullptr, 0), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_recorder_odometry(nullptr, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_recorder_bytes(nullptr, false, nullptr, 0, 0), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_simulator_unplug(nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_simulator_replug(nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_simulator_advance(nullptr, 1), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_simulator_take_truth(nullptr, nullptr, 0, &count), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_simulator_next_odometry(nullptr, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_port_monitor_next(nullptr, &plugged, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_to_xy(nullptr, 1, G4LIDAR_ROBOT, 180, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_to_polar(nullptr, 1, G4LIDAR_ROBOT, 180, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_fill_grid(nullptr, 0, nullptr, nullptr, 1), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_shaper_create(nullptr, nullptr, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_shaper_shape(nullptr, nullptr, 0, false, nullptr, 0), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_shaper_kept(nullptr, &count), nullptr);
  EXPECT_EQ(g4lidar_shaper_for_grid(nullptr, nullptr), nullptr);
  EXPECT_EQ(g4lidar_shaper_outside(nullptr), 0U);
  EXPECT_EQ(g4lidar_estimator_add_of_model(nullptr, nullptr, 0, "g4", nullptr),
            G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_grid_options_set_model(nullptr, "g4"), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_descriptor(nullptr), -1);
  EXPECT_EQ(g4lidar_poll_timeout_ms(nullptr), -1);
  EXPECT_EQ(g4lidar_deadline_ns(nullptr), INT64_MAX);
  EXPECT_EQ(g4lidar_port_monitor_descriptor(nullptr), -1);
  EXPECT_EQ(g4lidar_get_identity(nullptr), nullptr);
  EXPECT_EQ(g4lidar_name(nullptr), nullptr);
  EXPECT_EQ(g4lidar_get_recognition(nullptr), nullptr);
  EXPECT_EQ(g4lidar_get_counts(nullptr), nullptr);
  EXPECT_EQ(g4lidar_recorder_get_counts(nullptr), nullptr);
  EXPECT_EQ(g4lidar_playback_info(nullptr), nullptr);
  EXPECT_EQ(g4lidar_reader_info(nullptr), nullptr);
  EXPECT_EQ(g4lidar_simulator_path(nullptr), nullptr);
  EXPECT_EQ(g4lidar_simulator_get_state(nullptr), nullptr);
  EXPECT_EQ(g4lidar_ports_at(nullptr, 0), nullptr);
  EXPECT_EQ(g4lidar_ports_count(nullptr), 0U);
  EXPECT_EQ(g4lidar_mask_polygons(nullptr, &count), nullptr);
  EXPECT_EQ(g4lidar_wall_ns(nullptr, 5), 0);
  EXPECT_EQ(g4lidar_get_playback(nullptr), nullptr);
  EXPECT_EQ(g4lidar_background_get_playback(nullptr), nullptr);
  EXPECT_EQ(g4lidar_background_get_counts(nullptr), nullptr);
  EXPECT_EQ(g4lidar_background_get_state(nullptr), 0);
  g4lidar_background_free(nullptr);
  EXPECT_FALSE(g4lidar_is_scanning(nullptr));
  EXPECT_FALSE(g4lidar_is_recording(nullptr));
  EXPECT_FALSE(g4lidar_has_feature(nullptr));
  g4lidar_wake(nullptr);
  g4lidar_release(nullptr);
  g4lidar_free(nullptr);
  g4lidar_recorder_free(nullptr);
  g4lidar_reader_free(nullptr);
  g4lidar_simulator_free(nullptr);
  g4lidar_ports_free(nullptr);
  g4lidar_port_monitor_free(nullptr);
  g4lidar_mask_free(nullptr);
  g4lidar_estimator_free(nullptr);
  g4lidar_options_init(nullptr, 0);
}

TEST(CArguments, AFailedOpenGivesNoHandle) {
  g4lidar_lidar* made = reinterpret_cast<g4lidar_lidar*>(1);
  g4lidar_error why;
  EXPECT_EQ(g4lidar_open("/dev/no-such-port", &made, &why), G4LIDAR_NO_PORT);
  EXPECT_EQ(made, nullptr);
  EXPECT_EQ(why.task, G4LIDAR_OPENING);
  // Both may be followed by the ports of this computer.
  EXPECT_EQ(std::string(why.subject).rfind("/dev/no-such-port", 0), 0U) << why.subject;
  EXPECT_EQ(std::string(why.message).rfind("opening /dev/no-such-port", 0), 0U) << why.message;
  EXPECT_NE(std::string(why.message).find(": this port does not exist (ENOENT"), std::string::npos)
      << why.message;
  EXPECT_EQ(why.message[std::strlen(why.message) - 1], '.');
  EXPECT_GT(std::strlen(why.advice), 20U);
  EXPECT_EQ(why.is_fatal, 1);
}

TEST(CArguments, OptionsWithoutTheirSizeAreRefused) {
  const simulator device = simulate();
  g4lidar_options options{};
  g4lidar_lidar* made = nullptr;
  EXPECT_EQ(g4lidar_open_simulated(device.get(), &options, &made, nullptr), G4LIDAR_BAD_ARGUMENT);
  options = defaults();
  options.struct_size = offsetof(g4lidar_options, device_wait_ms) - 8;
  EXPECT_EQ(g4lidar_open_simulated(device.get(), &options, &made, nullptr), G4LIDAR_BAD_ARGUMENT);
  options.struct_size = 0xAAAAAAAA;
  EXPECT_EQ(g4lidar_open_simulated(device.get(), &options, &made, nullptr), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(made, nullptr);
}

// A program that was compiled with a newer header.
struct newer_options {
  g4lidar_options known;
  std::uint64_t added;
};

TEST(CArguments, NewerOptionsAreTakenIfTheNewMembersAreZero) {
  const simulator device = simulate();
  newer_options options;
  std::memset(static_cast<void*>(&options), 0xEE, sizeof options);
  g4lidar_options_init(&options.known, sizeof options);
  EXPECT_EQ(options.known.struct_size, sizeof options);
  EXPECT_EQ(options.added, 0U);
  EXPECT_EQ(options.known.baud, 0U);
  g4lidar_lidar* made = nullptr;
  EXPECT_EQ(g4lidar_open_simulated(device.get(), &options.known, &made, nullptr), G4LIDAR_OK);
  g4lidar_free(made);
  options.added = 1;
  EXPECT_EQ(g4lidar_open_simulated(device.get(), &options.known, &made, nullptr),
            G4LIDAR_BAD_ARGUMENT);
}

TEST(CArguments, InitWritesNoMoreThanItsSize) {
  std::array<unsigned char, sizeof(g4lidar_options)> memory;
  memory.fill(0xEE);
  g4lidar_options_init(reinterpret_cast<g4lidar_options*>(memory.data()), 32);
  for (std::size_t i = 32; i < memory.size(); ++i) ASSERT_EQ(memory[i], 0xEE) << i;
}

TEST(CArguments, ImpossibleOptionsAreNamed) {
  const simulator device = simulate();
  g4lidar_error why;
  const auto refused = [&](auto change) {
    g4lidar_options options = defaults();
    change(options);
    g4lidar_lidar* made = nullptr;
    EXPECT_EQ(g4lidar_open_simulated(device.get(), &options, &made, &why), G4LIDAR_BAD_OPTION);
    EXPECT_EQ(made, nullptr);
    return std::string(why.subject);
  };
  const auto names = [](const std::string& subject, const char* name) {
    return subject.rfind(name, 0) == 0;
  };
  EXPECT_EQ(refused([](auto& o) { o.frequency_chz = 70000; }), "frequency_chz: 300 to 1600, or 0");
  for (const int chz : {100, 4000}) {
    EXPECT_EQ(refused([chz](auto& o) { o.frequency_chz = chz; }),
              "frequency: 500 to 1200 (5 to 12 Hz of a G4), not " + std::to_string(chz));
  }
  EXPECT_EQ(refused([](auto& o) { o.sample_rate_hz = 5000; }),
            "sample_rate_hz: 4000, 6000, 8000, 9000, 10000, 16000, 18000, 20000 or 0");
  EXPECT_EQ(refused([](auto& o) { o.direction = 3; }), "direction: a g4lidar_direction or 0");
  EXPECT_EQ(refused([](auto& o) { o.low_power = -1; }), "low_power: a g4lidar_switch or 0");
  EXPECT_TRUE(names(refused([](auto& o) { o.constant_frequency = 3; }), "constant_frequency"));
  EXPECT_TRUE(names(refused([](auto& o) { o.protection = 9; }), "protection"));
  EXPECT_TRUE(names(refused([](auto& o) { o.pace = 3; }), "pace"));
  EXPECT_TRUE(names(refused([](auto& o) { o.answer_time_ms = 1; }), "answer_time"));
  EXPECT_TRUE(names(refused([](auto& o) { o.batch_ms = 101; }), "batch"));
  EXPECT_TRUE(names(refused([](auto& o) { o.transport_delay_ns = -1; }), "transport_delay"));
}

}  // namespace
