// SPDX-License-Identifier: MIT
// A signal ends g4-ros2 while it opens a small recording that unpacks to much; few files may be open.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include "cli/program.hpp"
#include "subscriber.hpp"
#include "support/hostile_mcap.hpp"

namespace ros2 {
namespace {

using namespace std::chrono_literals;

class InterruptedFile : public cli::scratch {
 protected:
  test_domain domain_;
};

TEST_F(InterruptedFile, FileThatUnpacksToMuch_DoesNotDelayTheEnd) {
  using namespace g4lidar::test;
  cli::write_file(path("slow.mcap"), slow_mcap());
  cli::program tool({path("slow.mcap")});  // opening it needs a minute
  std::this_thread::sleep_for(2s);
  tool.send(SIGTERM);
  const auto sent = std::chrono::steady_clock::now();
  const auto ended = tool.wait();
  EXPECT_LT(std::chrono::steady_clock::now() - sent, 20s);
  EXPECT_EQ(ended.code, 128 + SIGTERM) << ended.err;
}

TEST_F(InterruptedFile, FewDescriptors_AreAnErrorAndNoCrash) {
  for (const int limit : {8, 10, 11, 12, 13, 16}) {
    // Without the descriptors of what has started the test: the loader of libraries needs one.
    const std::string command = "exec 2>'" + path("err") +
                                "' 3>&- 4>&- 5>&- 6>&- 7>&- 8>&- 9>&-; ulimit -c 0; ulimit -n " +
                                std::to_string(limit) + "; exec '" G4_DUMP "' sim: --duration 1s";
    const int status = std::system(command.c_str());
    ASSERT_TRUE(WIFEXITED(status)) << limit;
    EXPECT_EQ(WEXITSTATUS(status), 10) << limit;
    EXPECT_NE(cli::read_file(path("err")).find("Too many files are open"), std::string::npos)
        << limit << cli::read_file(path("err"));
  }
}

}  // namespace
}  // namespace ros2
