// SPDX-License-Identifier: MIT
// Properties that a driver takes from its transport and not from its options; and transports
// without memory.
#include <gtest/gtest.h>

#include <cerrno>
#include <optional>

#include "discovery/system_connector.hpp"
#include "support/allocation_count.hpp"
#include "support/virtual_transport.hpp"
#include "transport/port_holder.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t ms = 1'000'000;

/// How long ago the last sample of the first packet was measured, when it arrived over a transport
/// with `baud`.
std::int64_t age_of_first_packet_ns(std::uint32_t baud) {
  test::virtual_bench bench;
  bench.baud = baud;
  auto lidar = test::open_virtual(bench);
  if (!lidar || !lidar->start()) return -1;
  const auto points = lidar->next_points(2000ms);
  return points ? bench.now_ns - points->back().time_ns : -1;
}

TEST(Transport, ByteTime_IsThatOfTheTransport) {
  const std::int64_t none = age_of_first_packet_ns(0);
  ASSERT_GE(none, 0);
  EXPECT_GT(age_of_first_packet_ns(23'040), none + 5 * ms);  // 12 bytes at least
}

TEST(Transport, NoMemoryAtReconnect_ProgramContinues) {
  for (const char* device : {"file:/dev/a-name-that-needs-memory", "tcp:a-name-that-needs-memory:1",
                             "/dev/a-name-that-needs-memory"}) {
    const auto connector = system_connector::make(device, 230'400);
    ASSERT_TRUE(connector);
    std::optional<error> refused;
    test::without_memory([&] {
      if (const auto port = (*connector)->connect(); !port) refused = port.error();
    });
    ASSERT_TRUE(refused) << device;
    EXPECT_EQ(refused->code(), problem::system) << device;
    EXPECT_EQ(refused->system_errno(), ENOMEM) << device;
  }
}

/// A port with a name that needs memory, and without bytes.
class silent_transport final : public transport {
 public:
  result<received> read(std::span<std::uint8_t>, std::int64_t) noexcept override { return {}; }
  result<void> write(bytes, std::int64_t) noexcept override { return {}; }
  result<void> pause(std::int64_t) noexcept override { return {}; }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return 0; }
  void wake() noexcept override {}
  [[nodiscard]] std::string_view name() const noexcept override {
    return "/dev/a-name-that-needs-memory";
  }
};

TEST(Transport, NoMemoryForTheHolder_ErrorIsReported) {
  const error why(task::asking, problem::timeout, "what was asked");
  std::optional<error> reported;
  test::without_memory([&] { reported = with_port_conflict(why, silent_transport()); });
  ASSERT_TRUE(reported);
  EXPECT_EQ(reported->code(), problem::timeout);
  EXPECT_EQ(reported->subject(), "what was asked");
}

}  // namespace
}  // namespace g4lidar
