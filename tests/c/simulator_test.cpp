// SPDX-License-Identifier: MIT
// The simulator, discovery and the event loop in C.
#include <poll.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;
using g4lidar::test::patience_ms;

constexpr std::int64_t second = 1'000'000'000;

TEST(CSimulator, KnowsTheTruth) {
  const simulator device = simulate("sim:?seed=5");
  const lidar it = start_on(device);
  std::vector<g4lidar_point> points;
  const g4lidar_point* some = nullptr;
  std::size_t count = 0;
  while (points.size() < 5000) {
    ASSERT_EQ(g4lidar_next_points(it.get(), 1000, &some, &count, nullptr), G4LIDAR_OK);
    points.insert(points.end(), some, some + count);
  }
  std::vector<g4lidar_truth> truth(16'384);
  ASSERT_EQ(g4lidar_simulator_take_truth(device.get(), truth.data(), truth.size(), &count),
            G4LIDAR_OK);
  ASSERT_GE(count, points.size());
  // Without noise the points are those of the world, in their order.
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((points[i].flags & G4LIDAR_NO_RETURN) != 0) continue;
    ASSERT_NEAR(static_cast<double>(points[i].range_mm), truth[i].range_mm, 0.126) << i;
    const double off =
        std::remainder(static_cast<double>(points[i].angle_deg) - truth[i].bearing_deg, 360.0);
    ASSERT_NEAR(off, 0.0, 0.03) << i;
  }
  EXPECT_EQ(g4lidar_simulator_take_truth(device.get(), nullptr, 1, &count), G4LIDAR_BAD_ARGUMENT);
}

TEST(CSimulator, HasAStateAndATime) {
  const simulator device = simulate();
  EXPECT_STREQ(g4lidar_simulator_path(device.get()), "");
  const g4lidar_simulator_state* state = g4lidar_simulator_get_state(device.get());
  EXPECT_EQ(state->time_ns, 0);
  EXPECT_TRUE(state->is_plugged);
  EXPECT_FALSE(state->is_scanning);
  ASSERT_EQ(g4lidar_simulator_advance(device.get(), 3 * second), G4LIDAR_OK);
  EXPECT_EQ(g4lidar_simulator_get_state(device.get())->time_ns, 3 * second);
  EXPECT_EQ(g4lidar_simulator_advance(device.get(), -1), G4LIDAR_BAD_ARGUMENT);
  const lidar it = start_on(device);
  ASSERT_NE(scan_at_speed(it), nullptr);
  state = g4lidar_simulator_get_state(device.get());
  EXPECT_TRUE(state->is_scanning && state->motor_turns);
  EXPECT_NEAR(state->motor_hz, 7.0F, 0.1F);
  EXPECT_GT(state->bytes_delivered, 10'000U);
  g4lidar_simulator_unplug(device.get());
  EXPECT_FALSE(g4lidar_simulator_get_state(device.get())->is_plugged);
  g4lidar_simulator_replug(device.get());
  EXPECT_EQ(g4lidar_simulator_get_state(device.get())->replugs, 1U);
}

TEST(CSimulator, NamesTheMistakeInATextAndItsLine) {
  g4lidar_simulator_options options;
  g4lidar_simulator_options_init(&options, sizeof options);
  g4lidar_simulator* made = nullptr;
  g4lidar_error why;
  options.setup = "sim:?speed=7";
  EXPECT_EQ(g4lidar_simulator_create(&options, &made, &why), G4LIDAR_BAD_OPTION);
  EXPECT_NE(std::strstr(why.message, "speed"), nullptr) << why.message;
  options.setup = nullptr;
  options.world = "wall 0 1 2\n";
  EXPECT_EQ(g4lidar_simulator_create(&options, &made, &why), G4LIDAR_BAD_FILE);
  EXPECT_EQ(std::strncmp(why.message, "line 1: ", 8), 0) << why.message;
  options.world = nullptr;
  options.path = "\ndrive sideways 3\n";
  EXPECT_EQ(g4lidar_simulator_create(&options, &made, &why), G4LIDAR_BAD_FILE);
  EXPECT_EQ(std::strncmp(why.message, "line 2: ", 8), 0) << why.message;
  options.path = nullptr;
  options.setup = "sim:?world=/no/such/file";
  EXPECT_EQ(g4lidar_simulator_create(&options, &made, &why), G4LIDAR_BAD_FILE);
  EXPECT_STREQ(why.subject, "/no/such/file");
  EXPECT_NE(std::strstr(why.message, "/no/such/file: it cannot be read"), nullptr) << why.message;
  options.setup = "sim:?seed=zzz";
  EXPECT_EQ(g4lidar_simulator_create(&options, &made, &why), G4LIDAR_BAD_OPTION);
  EXPECT_EQ(std::strncmp(why.message, "seed: 'zzz'", 11), 0) << why.message;
  EXPECT_EQ(made, nullptr);
}

TEST(CSimulator, OdometryFollowsTheRobot) {
  const simulator device = simulate(nullptr, nullptr, "drive forward 1 0.5\n");
  g4lidar_odometry odometry;
  ASSERT_EQ(g4lidar_simulator_next_odometry(device.get(), &odometry), G4LIDAR_OK);
  EXPECT_EQ(odometry.time_ns, 0);
  EXPECT_EQ(g4lidar_simulator_next_odometry(device.get(), &odometry), G4LIDAR_NOTHING);
  g4lidar_simulator_advance(device.get(), 5 * second);
  while (g4lidar_simulator_next_odometry(device.get(), &odometry) == G4LIDAR_OK) continue;
  EXPECT_EQ(odometry.time_ns, 5 * second);
  EXPECT_NEAR(odometry.pose.x_m, 1.0, 1e-6);
  const simulator standing = simulate();
  EXPECT_EQ(g4lidar_simulator_next_odometry(standing.get(), &odometry), G4LIDAR_NOTHING);
}

// One test: the environment is that of the whole process.
TEST(CDiscovery, RealTimeLidarIsListedFoundSelectedAndWoken) {
  const scratch directory;
  ::setenv("G4LIDAR_SIM_DIR", directory.path("").c_str(), 1);
  const std::string link = directory.path("g4-2021101000070222");
  g4lidar_simulator_options options;
  g4lidar_simulator_options_init(&options, sizeof options);
  options.setup = "sim:?serial=2021101000070222";
  options.link = link.c_str();
  g4lidar_simulator* created = nullptr;
  g4lidar_error why;
  ASSERT_EQ(g4lidar_simulator_create(&options, &created, &why), G4LIDAR_OK) << why.message;
  const simulator device(created);
  EXPECT_EQ(g4lidar_simulator_path(device.get()), link);
  EXPECT_EQ(g4lidar_simulator_advance(device.get(), 1), G4LIDAR_BAD_ARGUMENT);

  g4lidar_ports* list = nullptr;
  ASSERT_EQ(g4lidar_list_ports(nullptr, &list, &why), G4LIDAR_OK) << why.message;
  const ports all(list);
  const g4lidar_port* listed = nullptr;
  for (std::size_t i = 0; i < g4lidar_ports_count(all.get()); ++i) {
    const g4lidar_port* port = g4lidar_ports_at(all.get(), i);
    if (std::strstr(port->path, "g4-2021101000070222") != nullptr) listed = port;
  }
  ASSERT_NE(listed, nullptr);
  EXPECT_TRUE(listed->may_open && listed->is_g4_bridge);
  EXPECT_FALSE(listed->has_lidar);
  EXPECT_EQ(listed->vendor_id, 0x10c4);  // of Silicon Labs
  EXPECT_EQ(listed->product_id, 0xea60);
  EXPECT_STREQ(listed->by_id, "");
  EXPECT_EQ(g4lidar_ports_at(all.get(), g4lidar_ports_count(all.get())), nullptr);

  ASSERT_EQ(g4lidar_find_lidars(nullptr, &list, &why), G4LIDAR_OK) << why.message;
  const ports found(list);
  ASSERT_EQ(g4lidar_ports_count(found.get()), 1U);
  EXPECT_TRUE(g4lidar_ports_at(found.get(), 0)->has_lidar);
  EXPECT_STREQ(g4lidar_ports_at(found.get(), 0)->lidar.serial_number, "2021101000070222");
  ASSERT_EQ(g4lidar_select_port("serial:2021101000070222", nullptr, &list, &why), G4LIDAR_OK);
  const ports selected(list);
  EXPECT_EQ(g4lidar_ports_count(selected.get()), 1U);
  EXPECT_EQ(g4lidar_select_port("serial:none", nullptr, &list, &why), G4LIDAR_BAD_OPTION);
  EXPECT_EQ(list, nullptr);
  ::unsetenv("G4LIDAR_SIM_DIR");

  // Another thread wakes a call that waits.
  g4lidar_lidar* opened = nullptr;
  ASSERT_EQ(g4lidar_open(link.c_str(), &opened, &why), G4LIDAR_OK) << why.message;
  const lidar it(opened);
  ASSERT_EQ(g4lidar_start(it.get(), &why), G4LIDAR_OK) << why.message;
  const g4lidar_scan* scan = nullptr;
  // Poll until the first scan.
  int code = G4LIDAR_TIMEOUT;
  const auto end = std::chrono::steady_clock::now() + g4lidar::test::patience;
  while (code == G4LIDAR_TIMEOUT && std::chrono::steady_clock::now() < end) {
    pollfd waiting{g4lidar_descriptor(it.get()), POLLIN, 0};
    ASSERT_GE(waiting.fd, 0);
    ASSERT_GE(::poll(&waiting, 1, g4lidar_poll_timeout_ms(it.get())), 0);
    code = g4lidar_try_scan(it.get(), 0, &scan, &why);
  }
  ASSERT_EQ(code, G4LIDAR_OK) << why.message;
  EXPECT_GT(scan->point_count, 1000U);
  ASSERT_EQ(g4lidar_simulator_unplug(device.get()), G4LIDAR_OK);
  while (code == G4LIDAR_OK) code = g4lidar_try_scan(it.get(), patience_ms, &scan, &why);
  EXPECT_EQ(code, G4LIDAR_GONE);
  EXPECT_EQ(why.is_fatal, 1);
}

TEST(CRealTime, MonitorHasADescriptor) {
  g4lidar_port_monitor* monitor = nullptr;
  g4lidar_error why;
  ASSERT_EQ(g4lidar_port_monitor_open(&monitor, &why), G4LIDAR_OK) << why.message;
  EXPECT_GE(g4lidar_port_monitor_descriptor(monitor), 0);
  bool plugged = false;
  const g4lidar_port* port = nullptr;
  EXPECT_EQ(g4lidar_port_monitor_next(monitor, &plugged, &port), G4LIDAR_NOTHING);
  g4lidar_port_monitor_free(monitor);
}

}  // namespace
