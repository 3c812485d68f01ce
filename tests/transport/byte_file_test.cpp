// SPDX-License-Identifier: MIT
#include "g4lidar/transport/byte_file.hpp"

#include <vector>

#include "port_io.hpp"
#include "temporary_file.hpp"

namespace g4lidar::test {
namespace {

using namespace std::chrono_literals;

TEST(ByteFile, ReturnsItsBytesAndEnds) {
  const temporary_file file("some bytes");
  auto input = byte_file::open(file.path());
  ASSERT_TRUE(input) << input.error().message();
  EXPECT_EQ((*input)->baud(), 0U);
  EXPECT_EQ((*input)->name(), file.path());
  EXPECT_EQ(read_text(**input, 10), "some bytes");
  const auto after = read_text(**input, 1);
  ASSERT_FALSE(after);
  EXPECT_EQ(after.error().code(), problem::end_of_input);
}

TEST(ByteFile, WrittenBytes_AreDiscarded) {
  const temporary_file file("some bytes");
  auto input = byte_file::open(file.path());
  ASSERT_TRUE(input);
  EXPECT_TRUE(write_text(**input, "not to the file"));
  EXPECT_EQ(read_text(**input, 10), "some bytes");
}

TEST(ByteFile, AtARate_DeliversBurstsNoFaster) {
  const temporary_file file(std::string(2000, 'x'));
  auto input = byte_file::open(file.path(), {.bytes_per_second = 20'000});
  ASSERT_TRUE(input);
  EXPECT_EQ((*input)->baud(), 200'000U);
  std::array<std::uint8_t, 4096> buffer{};
  const std::int64_t began_ns = (*input)->now_ns();
  std::size_t count = 0;
  std::int64_t last_ns = 0;
  while (count < 2000) {
    const auto got = (*input)->read(buffer, never_ns);
    ASSERT_TRUE(got);
    EXPECT_TRUE(got->count >= 20 || count + got->count == 2000);
    EXPECT_GT(got->arrival_ns, last_ns);
    EXPECT_LE(got->arrival_ns, (*input)->now_ns());
    last_ns = got->arrival_ns;
    count += got->count;
    EXPECT_LE(count, 1 + static_cast<std::size_t>((*input)->now_ns() - began_ns) / 50'000);
  }
  EXPECT_GE(last_ns - began_ns, std::chrono::nanoseconds(100ms).count());
  EXPECT_EQ((*input)->read(buffer, never_ns).error().code(), problem::end_of_input);
}

TEST(ByteFile, AtARate_DeadlinesAreKept) {
  const temporary_file file("x");
  auto input = byte_file::open(file.path(), {.bytes_per_second = 1});
  ASSERT_TRUE(input);
  std::array<std::uint8_t, 4096> buffer{};
  EXPECT_EQ((*input)->read(buffer, in(**input, 5ms))->count, 0U);
  EXPECT_EQ((*input)->read(buffer, (*input)->now_ns())->count, 0U);
  (*input)->wake();
  EXPECT_EQ((*input)->read(buffer, never_ns).error().code(), problem::cancelled);
  (*input)->wake();
  EXPECT_EQ((*input)->pause(never_ns).error().code(), problem::cancelled);
}

TEST(ByteFile, NotAFile_IsRefused) {
  EXPECT_EQ(byte_file::open("/dev/null").error().code(), problem::bad_option);
  EXPECT_EQ(byte_file::open("/dev").error().code(), problem::bad_option);
  const auto missing = byte_file::open("/no/such/file");
  EXPECT_EQ(missing.error().code(), problem::system);
  EXPECT_EQ(missing.error().system_errno(), ENOENT);
}

}  // namespace
}  // namespace g4lidar::test
