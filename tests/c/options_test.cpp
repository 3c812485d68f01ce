// SPDX-License-Identifier: MIT
// Options of programs that were compiled with another version, and members that must be 0.
#include "c/versioned_options.hpp"

#include <cstdint>
#include <cstring>
#include <string>

#include "c_handles.hpp"

namespace {

using namespace g4lidar_c_test;
using g4lidar::c::take_options;

// Options as they were in the first version, and after two members were added.
struct first_options {
  std::size_t struct_size;
  std::int32_t value;
  std::uint8_t reserved[4];
};
struct grown_options {
  std::size_t struct_size;
  std::int32_t value;
  std::uint8_t reserved[4];
  double added;
  std::int32_t added_later;
};
constexpr grown_options grown_defaults{sizeof(grown_options), 1, {}, 2.5, 3};

TEST(COptions, AProgramOfTheFirstVersionHasTheDefaultsOfAddedMembers) {
  grown_options given{sizeof(first_options), 7, {}, 8.5, 9};  // it has no memory for the last two
  grown_options taken = grown_defaults;
  ASSERT_LT(sizeof(first_options), sizeof(grown_options));
  EXPECT_TRUE(take_options(&given, taken));
  EXPECT_EQ(taken.value, 7);
  EXPECT_EQ(taken.added, 2.5);
  EXPECT_EQ(taken.added_later, 3);

  given.struct_size = offsetof(grown_options, added_later);  // of the version between the two
  taken = grown_defaults;
  EXPECT_TRUE(take_options(&given, taken));
  EXPECT_EQ(taken.added, 8.5);
  EXPECT_EQ(taken.added_later, 3);

  given.struct_size = sizeof(first_options) - 1;
  EXPECT_FALSE(take_options(&given, taken));
}

TEST(COptions, ReservedBytesOfEveryVersionMustBeZero) {
  grown_options given = grown_defaults;
  for (const std::size_t size : {sizeof(first_options), sizeof(grown_options)}) {
    for (std::uint8_t& each : given.reserved) {
      grown_options taken = grown_defaults;
      given.struct_size = size;
      EXPECT_TRUE(take_options(&given, taken));
      each = 1;
      EXPECT_FALSE(take_options(&given, taken));
      each = 0;
    }
  }
}

// Whether options are taken with all of `reserved` 0, and refused with its last byte 1.
template <class Options, class Init, class Use>
void expect_reserved_is_checked(Init init, Use use) {
  Options options;
  std::memset(static_cast<void*>(&options), 0xEE, sizeof options);
  init(&options, sizeof options);
  EXPECT_EQ(use(&options), G4LIDAR_OK);
  options.reserved[sizeof options.reserved - 1] = 1;
  EXPECT_EQ(use(&options), G4LIDAR_BAD_ARGUMENT);
}

int result_of(const g4lidar_shaper_options& options) {
  g4lidar_shaper* made = nullptr;
  const int done = g4lidar_shaper_create(&options, &made, nullptr);
  g4lidar_shaper_free(made);
  return done;
}

TEST(COptions, ReservedBytesOfPointsAreChecked) {
  g4lidar_point point{};
  expect_reserved_is_checked<g4lidar_grid_options>(g4lidar_grid_options_init, [&](auto* options) {
    float range_m = 0;
    return g4lidar_fill_grid(&point, 1, options, &range_m, 1);
  });
  expect_reserved_is_checked<g4lidar_filter_options>(
      g4lidar_filter_options_init, [&](auto* options) {
        g4lidar_shaper_options shape = shaper_defaults();
        shape.filter = options;
        return result_of(shape);
      });
  expect_reserved_is_checked<g4lidar_outlier_options>(
      g4lidar_outlier_options_init, [&](auto* options) {
        g4lidar_shaper_options shape = shaper_defaults();
        shape.speckle = options;
        return result_of(shape);
      });
  expect_reserved_is_checked<g4lidar_near_options>(g4lidar_near_options_init, [&](auto* options) {
    g4lidar_shaper_options shape = shaper_defaults();
    shape.near_options = options;
    return result_of(shape);
  });
  expect_reserved_is_checked<g4lidar_shaper_options>(
      g4lidar_shaper_options_init, [&](auto* options) { return result_of(*options); });
}

// A recording of one revolution.
void record_briefly(const std::string& path) {
  const simulator device = simulate();
  g4lidar_recorder_options wanted;
  g4lidar_recorder_options_init(&wanted, sizeof wanted);
  wanted.overwrite = true;
  g4lidar_recorder* made = nullptr;
  ASSERT_EQ(g4lidar_recorder_create(path.c_str(), &wanted, &made, nullptr), G4LIDAR_OK);
  const recorder into(made);
  g4lidar_options options = defaults();
  options.recorder = made;
  next_whole(start_on(device, &options));
}

TEST(COptions, ReservedBytesOfHandlesAreChecked) {
  const simulator device = simulate();
  expect_reserved_is_checked<g4lidar_options>(g4lidar_options_init, [&](auto* options) {
    g4lidar_lidar* made = nullptr;
    const int code = g4lidar_open_simulated(device.get(), options, &made, nullptr);
    g4lidar_free(made);
    return code;
  });
  expect_reserved_is_checked<g4lidar_simulator_options>(
      g4lidar_simulator_options_init, [&](auto* options) {
        options->virtual_time = true;
        g4lidar_simulator* made = nullptr;
        const int code = g4lidar_simulator_create(options, &made, nullptr);
        g4lidar_simulator_free(made);
        return code;
      });
  expect_reserved_is_checked<g4lidar_find_options>(g4lidar_find_options_init, [](auto* options) {
    g4lidar_ports* made = nullptr;
    const int code = g4lidar_list_ports(options, &made, nullptr);
    g4lidar_ports_free(made);
    return code;
  });
}

TEST(COptions, ReservedBytesOfRecordingsAreChecked) {
  const scratch directory;
  const std::string path = directory.path("walk.mcap");
  expect_reserved_is_checked<g4lidar_recorder_options>(
      g4lidar_recorder_options_init, [&](auto* options) {
        options->overwrite = true;
        g4lidar_recorder* made = nullptr;
        const int code = g4lidar_recorder_create(path.c_str(), options, &made, nullptr);
        g4lidar_recorder_free(made);
        return code;
      });
  record_briefly(path);
  expect_reserved_is_checked<g4lidar_playback_options>(
      g4lidar_playback_options_init, [&](auto* options) {
        g4lidar_lidar* made = nullptr;
        const int code = g4lidar_open_recording(path.c_str(), options, nullptr, &made, nullptr);
        g4lidar_free(made);
        return code;
      });
  expect_reserved_is_checked<g4lidar_reader_options>(
      g4lidar_reader_options_init, [&](auto* options) {
        g4lidar_reader* made = nullptr;
        const int code = g4lidar_reader_open_with(path.c_str(), options, &made, nullptr);
        g4lidar_reader_free(made);
        return code;
      });
}

TEST(COptions, ReservedBytesOfAMountingAreChecked) {
  g4lidar_mounting mount{};
  g4lidar_shaper_options shape = shaper_defaults();
  shape.mount = &mount;
  EXPECT_EQ(result_of(shape), G4LIDAR_OK);
  mount.reserved[6] = 1;
  EXPECT_EQ(result_of(shape), G4LIDAR_BAD_ARGUMENT);
  const scratch directory;
  g4lidar_recorder_options options;
  g4lidar_recorder_options_init(&options, sizeof options);
  options.mount = &mount;
  g4lidar_recorder* made = nullptr;
  EXPECT_EQ(g4lidar_recorder_create(directory.path("a").c_str(), &options, &made, nullptr),
            G4LIDAR_BAD_ARGUMENT);
  EXPECT_EQ(made, nullptr);
}

}  // namespace
