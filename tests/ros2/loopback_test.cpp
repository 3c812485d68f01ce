// SPDX-License-Identifier: MIT
// LOCALHOST on a machine whose loopback has multicast, in a network namespace of the test.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <netpacket/packet.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "cli/program.hpp"
#include "subscriber.hpp"

namespace ros2 {
namespace {

/// A machine with loopback and a network, v0, whose other side is v1, for this thread and what it starts.
class machine {
 public:
  machine() : before_(::open("/proc/self/ns/net", O_RDONLY | O_CLOEXEC)) {
    if (before_ < 0 || ::unshare(CLONE_NEWNET) != 0) return;
    is_own_ = std::system(
                  "ip link set lo up && ip link set lo multicast on && "  // NOLINT
                  "ip link add v0 type veth peer name v1 && "
                  "ip address add 192.0.2.5/24 dev v0 && "
                  "ip link set v0 up && ip link set v1 up") == 0;
    const auto all = static_cast<std::uint16_t>(ETH_P_ALL);
    outside_ = ::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, htons(all));
    sockaddr_ll at{};
    at.sll_family = AF_PACKET;
    at.sll_protocol = htons(all);
    at.sll_ifindex = static_cast<int>(::if_nametoindex("v1"));
    EXPECT_EQ(::bind(outside_, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
  }
  ~machine() {
    ::close(outside_);
    EXPECT_EQ(::setns(before_, CLONE_NEWNET), 0);
    ::close(before_);
  }
  machine(const machine&) = delete;
  machine& operator=(const machine&) = delete;

  [[nodiscard]] bool is_own() const { return is_own_; }
  /// How many packets of UDP to the group of ROS 2, 239.255.0.1, have left since the last call.
  [[nodiscard]] std::size_t left() const {
    std::size_t count = 0;
    std::array<std::uint8_t, 2048> packet{};
    while (::recv(outside_, packet.data(), packet.size(), 0) > 20) {
      count += packet[0] >> 4U == 4U && packet[9] == IPPROTO_UDP && packet[16] == 239U ? 1U : 0U;
    }
    return count;
  }

 private:
  int before_;
  int outside_ = -1;
  bool is_own_ = false;
};

TEST(Loopback, WithMulticast_HumbleWithCycloneDdsFindsTheLidar_AndNothingLeavesTheMachine) {
  if (::geteuid() != 0) GTEST_SKIP() << "a network namespace needs root";
  const machine here;
  if (!here.is_own()) GTEST_SKIP() << "this system gives no network namespace";
  // What rmw_cyclonedds of Humble has for ROS_LOCALHOST_ONLY; the rest are the defaults of Cyclone DDS.
  const test_domain humble(
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
      "</Interfaces></General></Domain></CycloneDDS>");
  subscriber<scan_message> scans(humble, "/scan", dds::laser_scan);
  cli::program tool({"sim:"});
  std::size_t count = 0;
  EXPECT_TRUE(comes_true([&] { return (count += scans.take()) >= 10; })) << count;
  EXPECT_EQ(here.left(), 0U);
  tool.send(SIGINT);
  EXPECT_EQ(tool.wait().code, 130);
}

}  // namespace
}  // namespace ros2
