// SPDX-License-Identifier: MIT
// The bytes that Foxglove records are those of the lidar, in the message of recordings.
#include "byte_tap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace g4_tool {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// Each read gives the same bytes, one time unit later.
class steady_transport final : public g4lidar::transport {
 public:
  explicit steady_transport(std::vector<std::uint8_t> each) : each_(std::move(each)) {}
  g4lidar::result<g4lidar::received> read(std::span<std::uint8_t> out,
                                          std::int64_t /*deadline_ns*/) noexcept override {
    std::ranges::copy(each_, out.begin());
    return g4lidar::received{each_.size(), ++now_ns_};
  }
  g4lidar::result<void> write(g4lidar::bytes /*data*/,
                              std::int64_t /*deadline_ns*/) noexcept override {
    return {};
  }
  g4lidar::result<void> pause(std::int64_t /*deadline_ns*/) noexcept override { return {}; }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_; }
  void wake() noexcept override {}
  [[nodiscard]] std::string_view name() const noexcept override { return "steady"; }

 private:
  std::vector<std::uint8_t> each_;
  std::int64_t now_ns_ = 0;
};

TEST(ByteTap, KeepsWhatIsRead_OnceItIsWanted) {
  byte_tap tap;
  const auto port =
      tap.observe(std::make_unique<steady_transport>(std::vector<std::uint8_t>{7, 8}));
  std::array<std::uint8_t, 16> buffer{};
  ASSERT_TRUE(port->read(buffer, 0));
  EXPECT_THAT(tap.take(), IsEmpty());
  tap.want(true);
  ASSERT_TRUE(port->read(buffer, 0));
  ASSERT_TRUE(port->read(buffer, 0));
  EXPECT_EQ(tap.arrival_ns(), 3);
  // CDR, little-endian: int64 monotonic_ns, uint8[] data. (docs/recordings.md)
  EXPECT_THAT(tap.take(), ElementsAre(0, 1, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 7, 8, 7, 8));
  EXPECT_THAT(tap.take(), IsEmpty());
  ASSERT_TRUE(port->read(buffer, 0));
  tap.want(false);
  EXPECT_THAT(tap.take(), IsEmpty());
}

TEST(ByteTap, IsBoundedWhenNobodyTakes) {
  byte_tap tap;
  const auto port =
      tap.observe(std::make_unique<steady_transport>(std::vector<std::uint8_t>(1000, 1)));
  tap.want(true);
  std::array<std::uint8_t, 1000> buffer{};
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(port->read(buffer, 0));
  EXPECT_EQ(tap.arrival_ns(), 65);
  EXPECT_THAT(tap.take(), SizeIs(16 + 65'000));
}

}  // namespace
}  // namespace g4_tool
