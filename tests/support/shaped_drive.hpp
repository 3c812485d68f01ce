// SPDX-License-Identifier: MIT
// One drive for everything that shapes scans: a recording, and its points as `g4-dump convert` shapes them.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "g4lidar/motion.hpp"
#include "g4lidar/recording/reader.hpp"

namespace g4lidar::test {

/// A robot drives through a room and turns in front of a wall. The recording has its odometry, of another motion: only
/// that all use the same is compared.
class shaped_drive {
 public:
  /// `tool`: g4-dump; `directory`: for files. `deskew`: by the scans, where at the first one the motion is not known;
  /// or by the odometry, which begins late.
  shaped_drive(const std::string& tool, const std::string& directory,
               const std::string& deskew = "scans")
      : tool_(tool),
        begin_(directory + "/shaped_drive"),
        words_(" --speckle --edges --near --range 0.3: --deskew " + deskew) {
    std::ofstream(begin_ + ".txt") << "drive forward 2 1\ndrive turn 180 90\n";
    run("sim --seconds 6 --dropout 0.02 --path " + begin_ + ".txt -o " + begin_ + ".bin");
    {
      std::ofstream odometry(begin_ + ".odometry");
      for (int i = 16; i < 128; ++i) {
        odometry << i * std::int64_t{62'500'000} << ' ' << i / 64.0 << ' ' << i / 128.0 << ' '
                 << i / 32.0 << '\n';
      }
    }
    run("convert --force --odometry " + begin_ + ".odometry " + begin_ + ".bin " + recording());
    constexpr std::size_t header = 256;  // then points with the layout of g4lidar::point
    const std::string all = converted("npy");
    if (all.size() > header) bytes_ = all.substr(header);
    EXPECT_GT(bytes_.size(), 24U * 20'000U);
  }

  [[nodiscard]] std::string recording() const { return begin_ + ".mcap"; }
  /// The points of all scans, and of pieces of scans, 24 bytes each, with the times of their measurement.
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }
  /// The contents of a file in another format.
  [[nodiscard]] std::string converted(const std::string& format) const {
    const std::string path = begin_ + '.' + format;
    run("convert --force " + recording() + ' ' + path + " --time mono" + words_);
    return contents_of(path);
  }
  /// Those of the recording, where a yaw is a quaternion.
  [[nodiscard]] std::vector<stamped_pose> poses() const {
    auto from = recording_reader::open(recording());
    std::vector<stamped_pose> all;
    while (from) {
      const auto item = from->next();
      if (!item || !*item) break;
      if ((*item)->what != recorded_item::kind::odometry) continue;
      all.push_back({(*item)->odometry.time_ns, (*item)->odometry.pose});
    }
    EXPECT_GT(all.size(), 50U);
    return all;
  }

 private:
  void run(const std::string& words) const {
    const std::string command = tool_ + ' ' + words + " 2>/dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
  }
  static std::string contents_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream all;
    all << file.rdbuf();
    return all.str();
  }

  std::string tool_;
  std::string begin_;
  std::string words_;
  std::string bytes_;
};

}  // namespace g4lidar::test
