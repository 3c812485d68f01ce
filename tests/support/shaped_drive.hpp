// SPDX-License-Identifier: MIT
// One drive for everything that shapes scans: a recording, and its points as `g4-dump convert` shapes them.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace g4lidar::test {

/// The options of g4-dump. By the scans; at the first one the motion is not known.
inline constexpr const char* shaping_words = "--speckle --edges --near --range 0.3: --deskew scans";

/// A robot drives through a room and turns in front of a wall.
class shaped_drive {
 public:
  /// `tool`: g4-dump; `directory`: for files.
  shaped_drive(const std::string& tool, const std::string& directory)
      : begin_(directory + "/shaped_drive") {
    std::ofstream(begin_ + ".txt") << "drive forward 2 1\ndrive turn 180 90\n";
    run(tool + " sim --seconds 6 --dropout 0.02 --path " + begin_ + ".txt -o " + begin_ + ".bin");
    run(tool + " convert --force " + begin_ + ".bin " + recording());
    run(tool + " convert --force " + recording() + " " + begin_ + ".npy --time mono " +
        shaping_words);
    std::ifstream file(begin_ + ".npy", std::ios::binary);
    std::ostringstream all;
    all << file.rdbuf();
    constexpr std::size_t header = 256;  // then points with the layout of g4lidar::point
    if (all.str().size() > header) bytes_ = all.str().substr(header);
    EXPECT_GT(bytes_.size(), 24U * 20'000U);
  }

  [[nodiscard]] std::string recording() const { return begin_ + ".mcap"; }
  /// The points of all scans, and of pieces of scans, 24 bytes each, with the times of their measurement.
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }

 private:
  static void run(const std::string& command) {
    EXPECT_EQ(std::system((command + " 2>/dev/null").c_str()), 0) << command;
  }

  std::string begin_;
  std::string bytes_;
};

}  // namespace g4lidar::test
