// SPDX-License-Identifier: MIT
// A signal ends g4-serve while it opens a small recording that unpacks to much.
#include "server.hpp"
#include "support/hostile_mcap.hpp"

namespace serve {
namespace {

using namespace std::chrono_literals;

TEST_F(Server, FileThatUnpacksToMuch_DoesNotDelayTheEnd) {
  using namespace g4lidar::test;
  cli::write_file(path("slow.mcap"), hostile_mcap(chunk_of_a_foreign_message(), 10'000));
  begin({}, path("slow.mcap"));  // opening it needs many minutes
  std::this_thread::sleep_for(1s);
  const auto sent = std::chrono::steady_clock::now();
  const auto ended = end();
  EXPECT_LT(std::chrono::steady_clock::now() - sent, 20s);
  EXPECT_EQ(ended.code, 128 + SIGTERM) << cli::read_file(path("err"));
}

}  // namespace
}  // namespace serve
