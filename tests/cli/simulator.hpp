// SPDX-License-Identifier: MIT
// A simulated G4 on a pseudo-terminal, served by `g4-dump sim`, for tests of the other verbs.
#pragma once

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "program.hpp"
#include "support/patience.hpp"

namespace cli {

/// Served at `link` until the end, with more options of `g4-dump sim`.
class simulator {
 public:
  explicit simulator(const std::string& link, const std::vector<std::string>& options = {})
      : served_(arguments(link, options)) {
    EXPECT_TRUE(g4lidar::test::comes_true([&] { return std::filesystem::exists(link); })) << link;
  }

  /// The commands that it has been sent, a line each, as `sim --log` writes them. It ends.
  std::string log() {
    served_.send(SIGTERM);
    return served_.wait().err;
  }

 private:
  static std::vector<std::string> arguments(const std::string& link,
                                            const std::vector<std::string>& options) {
    std::filesystem::remove(link);  // that of an earlier one, which was killed
    std::vector<std::string> all{"sim", "--link", link, "--log"};
    all.insert(all.end(), options.begin(), options.end());
    return all;
  }

  program served_;
};

}  // namespace cli
