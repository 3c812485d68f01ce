// SPDX-License-Identifier: MIT
// A signal ends g4-serve while it opens a small recording that unpacks to much, or reads a large file without packets.
#include <cstdint>
#include <filesystem>

#include "server.hpp"
#include "support/hostile_mcap.hpp"

namespace serve {
namespace {

using namespace std::chrono_literals;

TEST_F(Server, AFileThatTakesLong_DoesNotDelayTheEnd) {
  cli::write_file(path("slow.mcap"), g4lidar::test::slow_mcap());
  cli::write_file(path("zeros.bin"), "");
  std::filesystem::resize_file(path("zeros.bin"), std::uintmax_t{1} << 38U);
  for (const char* const name : {"slow.mcap", "zeros.bin"}) {
    begin({}, path(name));  // opening it needs a minute, or reading it hours
    std::this_thread::sleep_for(1s);
    const auto sent = std::chrono::steady_clock::now();
    const auto ended = end();
    EXPECT_LT(std::chrono::steady_clock::now() - sent, 20s) << name;
    EXPECT_EQ(ended.code, 128 + SIGTERM) << cli::read_file(path("err"));
  }
}

}  // namespace
}  // namespace serve
