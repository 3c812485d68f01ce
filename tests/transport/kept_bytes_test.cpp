// SPDX-License-Identifier: MIT
// A driver that sleeps relies on the system to keep the bytes that arrive: as many as kept_bytes() returns.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "g4lidar/transport/serial_port.hpp"
#include "transport/listener.hpp"
#include "transport/pty.hpp"
#include "transport/tcp_port.hpp"

namespace g4lidar {
namespace {

constexpr std::int64_t second = 1'000'000'000;

std::string numbered(std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text.push_back(static_cast<char>(i * 7 + i / 256));
  return text;
}

/// Reads until `count` bytes have come, or nothing comes for a second.
std::string read_all(transport& from, std::size_t count) {
  std::string all;
  std::vector<std::uint8_t> some(65536);
  while (all.size() < count) {
    const auto got = from.read(some, from.now_ns() + second);
    EXPECT_TRUE(got);
    if (!got || got->count == 0) break;
    all.append(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(got->count));
  }
  return all;
}

// Written as a serial port does: in small portions.
TEST(KeptBytes, OfASerialPort_AreKeptWhileNobodyReads) {
  const test::pty device;
  const auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  const std::size_t kept = (*port)->kept_bytes();
  ASSERT_GE(kept, 4095U);
  ASSERT_EQ(::fcntl(device.master(), F_SETFL, O_NONBLOCK), 0);  // rather a failure than a wait
  const std::string sent = numbered(kept);
  for (std::size_t at = 0; at < sent.size(); at += 60) device.send(sent.substr(at, 60));
  EXPECT_EQ(read_all(**port, sent.size()), sent);
}

TEST(KeptBytes, OfANetworkBridge_AreKeptWhileNobodyReads) {
  test::listener bridge;
  const auto port = tcp_port::open(bridge.address());
  ASSERT_TRUE(port);
  bridge.accept();
  const std::string sent = numbered((*port)->kept_bytes());
  for (std::size_t at = 0; at < sent.size(); at += 60) bridge.send(sent.substr(at, 60));
  EXPECT_EQ(read_all(**port, sent.size()), sent);
}

/// A pty keeps more than a tty: 4095 bytes are in the line discipline, the rest before it.
TEST(KeptBytes, MoreThanTheSystemKeeps_IsRefused) {
  const test::pty device;
  const auto port = serial_port::open(device.path());
  ASSERT_TRUE(port);
  ASSERT_EQ(::fcntl(device.master(), F_SETFL, O_NONBLOCK), 0);
  const std::string portion = numbered(60);
  std::size_t taken = 0;
  for (ssize_t put = 0; (put = ::write(device.master(), portion.data(), portion.size())) > 0;) {
    taken += static_cast<std::size_t>(put);
    ASSERT_LT(taken, 1'000'000U);
  }
  EXPECT_GE(taken, (*port)->kept_bytes());
  EXPECT_EQ(read_all(**port, taken).size(), taken);
}

}  // namespace
}  // namespace g4lidar
