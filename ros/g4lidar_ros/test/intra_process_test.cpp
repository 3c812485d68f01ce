// SPDX-License-Identifier: MIT
// Within a process, a subscriber gets the memory that the thread of the lidar has filled: nothing is copied.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <thread>
#include <vector>

#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/laser_scan.hpp>

#include "g4lidar_ros/lidar_node.hpp"

namespace {

using sensor_msgs::msg::LaserScan;

/// The bytes of the ranges of a scan: a number that nothing else is likely to need.
constexpr std::size_t bins = 1237;
constexpr std::size_t watched_size = bins * sizeof(float);

/// An allocation of that size.
struct allocation {
  void* memory = nullptr;
  std::thread::id by;
};
std::array<allocation, 1024> allocations;  // NOLINT: operator new cannot be given it
std::atomic<std::size_t> count = 0;        // NOLINT: the same

std::thread::id thread_that_made(const void* memory) {
  for (std::size_t i = std::min(count.load(), allocations.size()); i > 0; --i) {
    if (allocations.at(i - 1).memory == memory) return allocations.at(i - 1).by;
  }
  return {};
}

rclcpp::NodeOptions within_process() { return rclcpp::NodeOptions().use_intra_process_comms(true); }

std::shared_ptr<g4lidar_ros::LidarNode> simulated_lidar() {
  auto options = within_process();
  options.parameter_overrides({{"source", "sim:?seed=1"},
                               {"grid", static_cast<int>(bins)},
                               {"mount", "0.1,0,0"},
                               {"deskew", "tf"},
                               {"autostart", true}});
  return std::make_shared<g4lidar_ros::LidarNode>(options);
}

class IntraProcess : public testing::Test {
 protected:
  void SetUp() override {
    rclcpp::init(0, nullptr);
    count = 0;
    lidar_ = simulated_lidar();
    subscriber_ = std::make_shared<rclcpp::Node>("subscriber", within_process());
    executor_ = std::make_unique<rclcpp::executors::SingleThreadedExecutor>();
    executor_->add_node(lidar_->get_node_base_interface());
    executor_->add_node(subscriber_);
  }
  void TearDown() override {
    executor_.reset();
    subscriber_.reset();
    lidar_.reset();
    rclcpp::shutdown();
  }

  template <class Condition>
  [[nodiscard]] bool spin_until(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!condition() && std::chrono::steady_clock::now() < end)
      executor_->spin_once(std::chrono::milliseconds(100));
    return condition();
  }

  std::shared_ptr<g4lidar_ros::LidarNode> lidar_;
  rclcpp::Node::SharedPtr subscriber_;
  std::unique_ptr<rclcpp::executors::SingleThreadedExecutor> executor_;
};

TEST_F(IntraProcess, AMessageIsThatOfThePublisher) {
  std::vector<std::thread::id> makers;
  const auto subscription =
      subscriber_->create_subscription<LaserScan>("scan", 5, [&](LaserScan::UniquePtr scan) {
        ASSERT_EQ(scan->ranges.size(), bins);
        makers.push_back(thread_that_made(scan->ranges.data()));
      });
  ASSERT_TRUE(spin_until([&] { return makers.size() >= 15; }));
  for (const std::thread::id& maker : makers) {
    EXPECT_EQ(maker, makers.front());
    EXPECT_NE(maker, std::thread::id());
    EXPECT_NE(maker, std::this_thread::get_id());
  }
  // One allocation for each message, and for those that are still on their way.
  EXPECT_LE(count, makers.size() + 5);
}

TEST_F(IntraProcess, SeveralSubscribersShareAMessage) {
  std::vector<LaserScan::ConstSharedPtr> first;
  std::vector<LaserScan::ConstSharedPtr> second;
  const auto one = subscriber_->create_subscription<LaserScan>(
      "scan", 5, [&](LaserScan::ConstSharedPtr scan) { first.push_back(scan); });
  const auto other = subscriber_->create_subscription<LaserScan>(
      "scan", 5, [&](LaserScan::ConstSharedPtr scan) { second.push_back(scan); });
  ASSERT_TRUE(spin_until([&] { return first.size() >= 15 && second.size() >= 15; }));
  std::size_t shared = 0;
  for (const auto& each : first)
    shared += static_cast<std::size_t>(std::count(second.begin(), second.end(), each));
  EXPECT_GE(shared, 14);
  EXPECT_LE(count, std::max(first.size(), second.size()) + 5);
  EXPECT_NE(thread_that_made(first.front()->ranges.data()), std::this_thread::get_id());
}

}  // namespace

// NOLINTBEGIN: these replace the ones of the standard library. Inlined ones would not fit each other.
[[gnu::noinline]] void* operator new(std::size_t size) {
  void* const memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  if (size == watched_size) {
    const std::size_t at = count.fetch_add(1);
    if (at < allocations.size()) allocations[at] = {memory, std::this_thread::get_id()};
  }
  return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}
// NOLINTEND
