// SPDX-License-Identifier: MIT
// A port that was lost and returns is noticed: by its node, its link, and its directory.
#include "discovery/path_watch.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "discovery/system_connector.hpp"
#include "support/test_scale.hpp"
#include "transport/pty.hpp"

namespace g4lidar {
namespace {

namespace fs = std::filesystem;

struct PathWatch : testing::Test {
  PathWatch() {
    std::string name = (fs::temp_directory_path() / "watch.XXXXXX").string();
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    directory = name;
  }
  ~PathWatch() override { fs::remove_all(directory); }

  static bool is_readable(int handle) {
    pollfd polled{handle, POLLIN, 0};
    return ::poll(&polled, 1, 0) == 1;
  }
  static void touch(const fs::path& path) { std::ofstream(path) << "x"; }

  fs::path directory;
};

TEST_F(PathWatch, NoChange_IsNotReported) {
  path_watch watch((directory / "g4").string());
  EXPECT_FALSE(is_readable(watch.native_handle()));
  EXPECT_FALSE(watch.take());
}

TEST_F(PathWatch, CreatedOrRenamedLink_IsReported) {
  path_watch watch((directory / "g4").string());
  fs::create_symlink("/dev/null", directory / "g4");
  EXPECT_TRUE(is_readable(watch.native_handle()));
  EXPECT_TRUE(watch.take());
  EXPECT_FALSE(watch.take());
  fs::create_symlink("/dev/zero", directory / "next");
  fs::rename(directory / "next", directory / "g4");
  EXPECT_TRUE(watch.take());
}

TEST_F(PathWatch, Permissions_AreReported) {
  touch(directory / "g4");
  path_watch watch((directory / "g4").string());
  fs::permissions(directory / "g4", fs::perms::owner_all);
  EXPECT_TRUE(watch.take());
}

TEST_F(PathWatch, OtherFiles_AreIgnored) {
  path_watch watch((directory / "g4").string());
  touch(directory / "other");
  fs::remove(directory / "other");
  EXPECT_FALSE(watch.take());
}

TEST_F(PathWatch, MissingDirectory_IsWatchedWhenItAppears) {
  const fs::path links = directory / "serial" / "by-id";
  path_watch watch((links / "usb-CP2102").string());
  for (int round = 0; round < 3; ++round) {
    fs::create_directories(links);
    EXPECT_TRUE(watch.take()) << round;
    fs::create_symlink("/dev/null", links / "usb-CP2102");
    EXPECT_TRUE(watch.take()) << round;
    fs::remove_all(directory / "serial");
    EXPECT_TRUE(watch.take()) << round;
  }
}

TEST_F(PathWatch, PathWithoutADirectory_IsInTheCurrentOne) {
  const fs::path before = fs::current_path();
  fs::current_path(directory);
  path_watch watch("g4");
  touch("g4");
  EXPECT_TRUE(watch.take());
  fs::current_path(before);
}

std::size_t open_descriptors() {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator()));
}

// 10,000 with G4LIDAR_TEST_SCALE=50.
TEST_F(PathWatch, Unplugs_LeaveNoDescriptor) {
  const test::pty port;
  const fs::path link = directory / "g4";
  fs::create_symlink(port.path(), link);
  auto made = system_connector::make(link.string(), 230'400);
  ASSERT_TRUE(made);
  connector& lines = **made;
  ASSERT_TRUE(lines.connect());
  EXPECT_GE(lines.watch(), 0);
  const std::size_t before = open_descriptors();
  for (int round = 0; round < test::scaled(200); ++round) {
    fs::remove(link);
    ASSERT_FALSE(lines.connect());
    ASSERT_EQ(lines.watch(), lines.watch());
    fs::create_symlink(port.path(), link);
    ASSERT_TRUE(lines.pause(lines.now_ns() + 10'000'000'000));
    ASSERT_TRUE(lines.may_be_back());
    ASSERT_TRUE(lines.connect()) << round;
  }
  EXPECT_EQ(open_descriptors(), before);
}

}  // namespace
}  // namespace g4lidar
