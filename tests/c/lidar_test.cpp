// SPDX-License-Identifier: MIT
// A lidar in C: scans, points, settings, events, closing.
#include <ctime>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;

TEST(CLidar, GivesWholeRevolutions) {
  const simulator device = simulate("sim:?seed=5");
  const lidar it = start_on(device);
  EXPECT_TRUE(g4lidar_is_scanning(it.get()));
  const g4lidar_scan* scan = scan_at_speed(it);
  ASSERT_NE(scan, nullptr);
  // 9000 samples a second at 7 Hz.
  EXPECT_NEAR(static_cast<double>(scan->point_count), 9000.0 / 7.0, 100.0);
  EXPECT_EQ(scan->sample_rate_hz, 9000U);
  EXPECT_NEAR(scan->turned_deg, 360.0F, 1.0F);
  EXPECT_NEAR(scan->reported_frequency_hz, 7.0F, 0.11F);
  EXPECT_FALSE(scan->is_piece);
  EXPECT_STREQ(scan->model, "g4");
  EXPECT_EQ(scan->turn_deg, 180);
  EXPECT_EQ(scan->longest_range_mm, 16000.0F);
  EXPECT_EQ(scan->default_bins, 720U);
  EXPECT_EQ(scan->flags, 0U);
  EXPECT_EQ(scan->time_ns, scan->points[0].time_ns);
  EXPECT_EQ(scan->end_ns, scan->time_ns + scan->duration_ns);
  EXPECT_EQ(scan->points[0].flags & G4LIDAR_REVOLUTION_START, G4LIDAR_REVOLUTION_START);
  for (std::size_t i = 1; i < scan->point_count; ++i) {
    ASSERT_GT(scan->points[i].time_ns, scan->points[i - 1].time_ns);
  }
}

TEST(CLidar, CountsEveryByte) {
  const simulator device = simulate("sim:?seed=5&fault=flip*0.001");
  const lidar it = start_on(device);
  std::size_t points = 0;
  const g4lidar_point* some = nullptr;
  std::size_t count = 0;
  while (g4lidar_simulator_get_state(device.get())->time_ns < 5'000'000'000) {
    ASSERT_EQ(g4lidar_next_points(it.get(), 1000, &some, &count, nullptr), G4LIDAR_OK);
    ASSERT_GT(count, 0U);
    points += count;
  }
  const g4lidar_counts* all = g4lidar_get_counts(it.get());
  EXPECT_GT(all->skipped_bad_checksum, 0U);
  EXPECT_EQ(all->bytes, all->parsed_bytes + all->skipped_noise + all->skipped_bad_header +
                            all->skipped_bad_checksum + all->skipped_truncated + all->held);
  EXPECT_EQ(all->points, points + all->points_missed);
  EXPECT_GT(all->packets, 500U);
}

TEST(CLidar, CountsTimePacketsAndRevolutionsWithCrc) {
  const simulator device = simulate("sim:?ct_crc=true&time_packet_ns=100ms&fault=omit*1@6s+6ms");
  const lidar it = start_on(device);
  int flagged = 0;
  const g4lidar_scan* scan = nullptr;
  while (g4lidar_simulator_get_state(device.get())->time_ns < 9'000'000'000) {
    ASSERT_EQ(g4lidar_try_scan(it.get(), 5000, &scan, nullptr), G4LIDAR_OK);
    flagged += (scan->flags & G4LIDAR_CRC_MISMATCH) != 0;
  }
  const g4lidar_counts* all = g4lidar_get_counts(it.get());
  EXPECT_EQ(flagged, 1);
  EXPECT_EQ(all->extras.crc_mismatches, 1U);
  EXPECT_GT(all->extras.crc_matches, 30U);
  EXPECT_GT(all->extras.time_packets, 60U);
  EXPECT_EQ(all->bytes, all->parsed_bytes + all->skipped_noise + all->skipped_bad_header +
                            all->skipped_bad_checksum + all->skipped_truncated + all->held);
}

/// Before each zero packet an empty one, as of some X2.
TEST(CLidar, CountsEmptyPackets) {
  const simulator device = simulate("sim:?model=x2&empty_packets=true");
  const lidar it = start_on(device);
  const g4lidar_scan* scan = nullptr;
  std::uint64_t turns = 0;
  for (; turns < 20; ++turns)
    ASSERT_EQ(g4lidar_try_scan(it.get(), 5000, &scan, nullptr), G4LIDAR_OK);
  const g4lidar_counts* all = g4lidar_get_counts(it.get());
  EXPECT_GE(all->extras.empty_packets, turns);
  EXPECT_LE(all->extras.empty_packets, turns + 10);
}

TEST(CLidar, KnowsTheDevice) {
  const simulator device = simulate("sim:?serial=2021101000070999&firmware=3.7");
  const lidar it = open_on(device);
  const g4lidar_identity* identity = g4lidar_get_identity(it.get());
  EXPECT_STREQ(identity->serial_number, "2021101000070999");
  EXPECT_EQ(identity->model, 5);
  EXPECT_EQ(identity->firmware_major, 3);
  EXPECT_EQ(identity->firmware_minor, 7);
  EXPECT_STREQ(g4lidar_name(it.get()), "virtual:g4");
  const g4lidar_recognition* const known = g4lidar_get_recognition(it.get());
  ASSERT_NE(known, nullptr);
  EXPECT_STREQ(known->model, "g4");
  EXPECT_STREQ(known->candidates, "g4");
  EXPECT_STREQ(known->contradictions, "");
  EXPECT_EQ(known->number, 5);
  EXPECT_EQ(known->baud, 230'400U);
  g4lidar_health health{99, 99};
  ASSERT_EQ(g4lidar_get_health(it.get(), G4LIDAR_REFUSE, &health, nullptr), G4LIDAR_OK);
  EXPECT_EQ(health.status, G4LIDAR_HEALTHY);
  EXPECT_EQ(health.error_code, 0U);
}

TEST(CLidar, ReportsTheHealthOfTheDevice) {
  const simulator device = simulate("sim:?fault=health=warning");
  const lidar it = open_on(device);
  g4lidar_health health{99, 99};
  ASSERT_EQ(g4lidar_get_health(it.get(), G4LIDAR_REFUSE, &health, nullptr), G4LIDAR_OK);
  EXPECT_EQ(health.status, G4LIDAR_HEALTH_WARNING);
  EXPECT_NE(health.error_code, 0U);
}

TEST(CLidar, SetsAndGetsEverySetting) {
  const simulator device = simulate();
  const lidar it = open_on(device);
  const auto set = [&](int setting, int wanted) {
    std::int32_t reached = -1;
    g4lidar_error why;
    EXPECT_EQ(g4lidar_set(it.get(), setting, wanted, G4LIDAR_REFUSE, &reached, &why), G4LIDAR_OK)
        << why.message;
    return reached;
  };
  const auto get = [&](int setting) {
    std::int32_t value = -1;
    g4lidar_get(it.get(), setting, G4LIDAR_REFUSE, &value, nullptr);
    return value;
  };
  EXPECT_EQ(get(G4LIDAR_SCAN_FREQUENCY), 700);
  EXPECT_EQ(set(G4LIDAR_SCAN_FREQUENCY, 1000), 1000);
  EXPECT_EQ(get(G4LIDAR_SCAN_FREQUENCY), 1000);
  EXPECT_EQ(get(G4LIDAR_SAMPLE_RATE), 9000);
  for (const int hz : {4000, 8000, 9000}) {
    EXPECT_EQ(set(G4LIDAR_SAMPLE_RATE, hz), hz);
    EXPECT_EQ(get(G4LIDAR_SAMPLE_RATE), hz);
  }
  EXPECT_EQ(get(G4LIDAR_MOTOR_DIRECTION), G4LIDAR_CLOCKWISE);
  EXPECT_EQ(set(G4LIDAR_MOTOR_DIRECTION, G4LIDAR_COUNTER_CLOCKWISE), G4LIDAR_COUNTER_CLOCKWISE);
  EXPECT_EQ(get(G4LIDAR_MOTOR_DIRECTION), G4LIDAR_COUNTER_CLOCKWISE);
  EXPECT_EQ(get(G4LIDAR_LOW_POWER), G4LIDAR_ON);
  EXPECT_EQ(set(G4LIDAR_LOW_POWER, G4LIDAR_OFF), G4LIDAR_OFF);
  EXPECT_EQ(get(G4LIDAR_LOW_POWER), G4LIDAR_OFF);
  for (const int setting : {G4LIDAR_CONSTANT_FREQUENCY, G4LIDAR_POWER_DOWN_PROTECTION}) {
    EXPECT_EQ(set(setting, G4LIDAR_OFF), G4LIDAR_OFF);
    EXPECT_EQ(set(setting, G4LIDAR_ON), G4LIDAR_ON);
    std::int32_t value = 7;
    EXPECT_EQ(g4lidar_get(it.get(), setting, G4LIDAR_REFUSE, &value, nullptr),
              G4LIDAR_BAD_ARGUMENT);
    EXPECT_EQ(value, 7);
  }
  std::int32_t reached = 0;
  EXPECT_EQ(g4lidar_step_frequency(it.get(), -100, G4LIDAR_REFUSE, &reached, nullptr), G4LIDAR_OK);
  EXPECT_EQ(reached, 900);
  EXPECT_EQ(g4lidar_step_frequency(it.get(), 10, G4LIDAR_REFUSE, &reached, nullptr), G4LIDAR_OK);
  EXPECT_EQ(reached, 910);
  EXPECT_EQ(g4lidar_restart(it.get(), G4LIDAR_REFUSE, nullptr), G4LIDAR_OK);
}

TEST(CLidar, RefusesImpossibleSettings) {
  const simulator device = simulate();
  const lidar it = open_on(device);
  const auto refused = [&](int setting, int wanted) {
    std::int32_t reached = 7;
    const int code = g4lidar_set(it.get(), setting, wanted, G4LIDAR_REFUSE, &reached, nullptr);
    EXPECT_EQ(reached, 7);
    return code;
  };
  g4lidar_error why;
  std::int32_t unused = 0;
  g4lidar_set(it.get(), G4LIDAR_SCAN_FREQUENCY, 4000, G4LIDAR_REFUSE, &unused, &why);
  EXPECT_NE(std::string(why.message).find("40 Hz (5 Hz to 12 Hz of a G4)"), std::string::npos)
      << why.message;
  EXPECT_EQ(refused(G4LIDAR_SCAN_FREQUENCY, 499), G4LIDAR_BAD_SETTING);
  EXPECT_EQ(refused(G4LIDAR_SCAN_FREQUENCY, -1), G4LIDAR_BAD_SETTING);
  EXPECT_EQ(refused(G4LIDAR_SCAN_FREQUENCY, 65536 + 700), G4LIDAR_BAD_SETTING);
  EXPECT_EQ(refused(G4LIDAR_SAMPLE_RATE, 5000), G4LIDAR_BAD_SETTING);
  for (const int setting : {G4LIDAR_MOTOR_DIRECTION, G4LIDAR_LOW_POWER, G4LIDAR_CONSTANT_FREQUENCY,
                            G4LIDAR_POWER_DOWN_PROTECTION}) {
    EXPECT_EQ(refused(setting, 0), G4LIDAR_BAD_SETTING) << setting;
    EXPECT_EQ(refused(setting, 3), G4LIDAR_BAD_SETTING) << setting;
  }
  EXPECT_EQ(refused(99, 1), G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(g4lidar_step_frequency(it.get(), 5, G4LIDAR_REFUSE, nullptr, nullptr),
            G4LIDAR_BAD_ARGUMENT);
}

TEST(CLidar, InterruptsARunningScanOnlyIfAllowed) {
  const simulator device = simulate();
  const lidar it = start_on(device);
  g4lidar_error why;
  std::int32_t value = 0;
  EXPECT_EQ(g4lidar_get(it.get(), G4LIDAR_SCAN_FREQUENCY, G4LIDAR_REFUSE, &value, &why),
            G4LIDAR_SCANNING);
  EXPECT_EQ(why.is_fatal, 0);
  EXPECT_EQ(g4lidar_get(it.get(), G4LIDAR_SCAN_FREQUENCY, G4LIDAR_STOP_AND_RESUME, &value, &why),
            G4LIDAR_OK);
  EXPECT_EQ(value, 700);
  EXPECT_EQ(g4lidar_get(it.get(), G4LIDAR_SCAN_FREQUENCY, 2, &value, &why), G4LIDAR_BAD_ARGUMENT);
  EXPECT_NE(next_whole(it), nullptr);
}

TEST(CLidar, ReportsAnUnplugAndReconnects) {
  const simulator device = simulate();
  g4lidar_options options = defaults();
  options.reconnect = true;
  const lidar it = start_on(device, &options);
  ASSERT_NE(next_whole(it), nullptr);
  g4lidar_event event;
  while (g4lidar_next_event(it.get(), &event) == G4LIDAR_OK) continue;
  ASSERT_EQ(g4lidar_simulator_unplug(device.get()), G4LIDAR_OK);
  const g4lidar_scan* scan = nullptr;
  g4lidar_error why;
  int code = G4LIDAR_OK;
  while (code == G4LIDAR_OK) code = g4lidar_try_scan(it.get(), 300, &scan, &why);
  EXPECT_EQ(code, G4LIDAR_RECONNECTING);
  EXPECT_EQ(why.is_fatal, 0);
  ASSERT_EQ(g4lidar_next_event(it.get(), &event), G4LIDAR_OK);
  EXPECT_EQ(event.kind, G4LIDAR_EVENT_LOST);
  EXPECT_EQ(event.reason, G4LIDAR_GONE);
  EXPECT_STREQ(g4lidar_event_name(event.kind), "lost");
  EXPECT_EQ(g4lidar_next_event(it.get(), &event), G4LIDAR_NOTHING);
  ASSERT_EQ(g4lidar_simulator_replug(device.get()), G4LIDAR_OK);
  EXPECT_NE(next_whole(it), nullptr);
  ASSERT_EQ(g4lidar_next_event(it.get(), &event), G4LIDAR_OK);
  EXPECT_EQ(event.kind, G4LIDAR_EVENT_RECONNECTED);
  EXPECT_EQ(g4lidar_get_counts(it.get())->reconnects, 1U);
}

TEST(CLidar, WakesAWaitingCall) {
  const simulator device = simulate();
  const lidar it = open_on(device);
  g4lidar_wake(it.get());
  g4lidar_error why;
  EXPECT_EQ(g4lidar_start(it.get(), &why), G4LIDAR_CANCELLED);
  EXPECT_EQ(why.is_fatal, 0);
  EXPECT_EQ(g4lidar_start(it.get(), &why), G4LIDAR_OK) << why.message;
  EXPECT_EQ(why.code, G4LIDAR_OK);
  EXPECT_STREQ(why.message, "");
}

TEST(CLidar, FailsWithGoneAfterClose) {
  const simulator device = simulate();
  const lidar it = start_on(device);
  ASSERT_NE(next_whole(it), nullptr);
  ASSERT_EQ(g4lidar_close(it.get(), nullptr), G4LIDAR_OK);
  EXPECT_FALSE(g4lidar_simulator_get_state(device.get())->is_scanning);
  const g4lidar_scan* scan = nullptr;
  const g4lidar_point* points = nullptr;
  std::size_t count = 0;
  std::int32_t value = 0;
  g4lidar_health health;
  g4lidar_event event;
  g4lidar_lidar* closed = it.get();
  EXPECT_EQ(g4lidar_start(closed, nullptr), G4LIDAR_GONE);
  // The scan that had arrived before is given first.
  while (g4lidar_try_scan(closed, 0, &scan, nullptr) == G4LIDAR_OK) continue;
  EXPECT_EQ(g4lidar_try_scan(closed, 100, &scan, nullptr), G4LIDAR_GONE);
  EXPECT_EQ(g4lidar_next_points(closed, 100, &points, &count, nullptr), G4LIDAR_GONE);
  EXPECT_EQ(g4lidar_process(closed, nullptr), G4LIDAR_GONE);
  EXPECT_EQ(g4lidar_get(closed, G4LIDAR_SCAN_FREQUENCY, 0, &value, nullptr), G4LIDAR_GONE);
  EXPECT_EQ(g4lidar_set(closed, G4LIDAR_SCAN_FREQUENCY, 700, 0, &value, nullptr), G4LIDAR_GONE);
  EXPECT_EQ(g4lidar_get_health(closed, 0, &health, nullptr), G4LIDAR_GONE);
  EXPECT_EQ(g4lidar_restart(closed, 0, nullptr), G4LIDAR_GONE);
  g4lidar_next_event(closed, &event);
  g4lidar_wake(closed);
  g4lidar_release(closed);
  EXPECT_FALSE(g4lidar_is_scanning(closed));
  EXPECT_EQ(g4lidar_descriptor(closed), -1);
  EXPECT_EQ(g4lidar_deadline_ns(closed), INT64_MAX);
  EXPECT_EQ(g4lidar_poll_timeout_ms(closed), -1);
  EXPECT_EQ(g4lidar_get_identity(closed)->model, 5);
  EXPECT_GT(g4lidar_get_counts(closed)->bytes, 0U);
  EXPECT_NE(g4lidar_name(closed), nullptr);
}

TEST(CLidar, ReleaseLeavesTheScanRunning) {
  const simulator device = simulate();
  {
    const lidar it = start_on(device);
    g4lidar_release(it.get());
  }
  EXPECT_TRUE(g4lidar_simulator_get_state(device.get())->is_scanning);
}

TEST(CLidar, OutlivesItsSimulator) {
  simulator device = simulate();
  const lidar it = start_on(device);
  device.reset();
  EXPECT_NE(next_whole(it), nullptr);
}

TEST(CLidar, ConvertsTimesToTheWallClock) {
  const simulator device = simulate();
  const std::int64_t before_s = std::time(nullptr);
  const lidar it = start_on(device);
  const g4lidar_scan* scan = next_whole(it);
  ASSERT_NE(scan, nullptr);
  const std::int64_t wall_ns = g4lidar_wall_ns(it.get(), scan->time_ns);
  EXPECT_NEAR(static_cast<double>(wall_ns) * 1e-9, static_cast<double>(before_s), 60.0);
  EXPECT_EQ(g4lidar_wall_ns(it.get(), scan->time_ns + 5), wall_ns + 5);
}

}  // namespace
