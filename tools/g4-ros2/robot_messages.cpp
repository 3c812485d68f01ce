// SPDX-License-Identifier: MIT
#include "robot_messages.hpp"

#include <algorithm>
#include <utility>

#include <messages.h>
#include "g4lidar/message/ros_messages.hpp"
#include "io/far_times.hpp"
#include "scan_messages.hpp"

namespace g4_tool {
namespace {

constexpr std::int64_t clock_step_ns = 10'000'000;

/// Nothing for one that no robot has.
std::optional<stamped_odometry> odometry_of(const nav_msgs_msg_dds__Odometry_& message) {
  const auto& [place, turn] = message.pose.pose;
  const auto& [linear, angular] = message.twist.twist;
  return planar_odometry(
      std::int64_t{message.header.stamp.sec} * 1'000'000'000 + message.header.stamp.nanosec,
      {place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w},
      {linear.x, linear.y, linear.z, angular.x, angular.y, angular.z});
}

}  // namespace

robot_messages::robot_messages(dds::bus& bus, const ros2_options& options,
                               std::string_view name_space, const robot_knowledge& known)
    : options_(options) {
  if (known.has_odometry) {
    odometry_ = publisher_of(bus, name_space, options.topics.odometry, {.type = &dds::odometry});
    tf_ = publisher_of(bus, options.name_space, options.topics.tf,
                       {.type = &dds::tf_message, .depth = 100});
  }
  if (known.has_clock) clock_ = publisher_of(bus, "", "/clock", {.type = &dds::clock_message});
}

void robot_messages::publish(const stamped_odometry& odometry, std::int64_t stamp_ns) {
  if (odometry_ && odometry_->is_wanted()) {
    message_.clear();
    put_odometry({.stamp_ns = stamp_ns,
                  .frame_id = options_.frames.odometry,
                  .child_frame_id = options_.frames.robot,
                  .pose = odometry.pose,
                  .twist = odometry.twist},
                 message_);
    odometry_->publish(message_);
  }
  if (tf_ && tf_->is_wanted()) {
    message_.clear();
    put_tf_message({.stamp_ns = stamp_ns,
                    .frame_id = options_.frames.odometry,
                    .child_frame_id = options_.frames.robot,
                    .place = {odometry.pose, false}},
                   message_);
    tf_->publish(message_);
  }
}

void robot_messages::publish_clock(std::int64_t now_ns) {
  const std::int64_t since_ns = way_ns(clock_ns_, now_ns);
  if (!clock_ || !clock_->is_wanted() || (since_ns > -clock_step_ns && since_ns < clock_step_ns))
    return;
  clock_ns_ = now_ns;
  message_.clear();
  put_clock(now_ns, message_);
  clock_->publish(message_);
}

std::string where_odometry_is(const ros2_options& options, std::string_view name_space) {
  const std::string& topic = options.topics.odometry;
  return topic == "off" ? "(--odometry-topic is off)" : "on " + full_name(name_space, topic);
}

std::vector<std::uint8_t> place_message(const ros2_options& options, const std::string& frame_id,
                                        const mounting& place) {
  std::vector<std::uint8_t> message;
  const bool is_turned = options.order == scan_order::time;
  put_tf_message({.frame_id = options.frames.robot,
                  .child_frame_id = frame_id,
                  .place = {place.pose, place.upside_down != is_turned}},
                 message);
  return message;
}

odometry_subscription::odometry_subscription(dds::bus& bus, std::string name)
    : dds::endpoint(bus), name_(std::move(name)) {
  bus.add(*this);
}

void odometry_subscription::open(dds_entity_t participant, int* /*handle*/) {
  const std::lock_guard lock(mutex_);
  // For every publisher: with best effort every quality of service is accepted.
  const dds::qos quality =
      dds::qos_of({.type = &dds::odometry, .is_reliable = false, .depth = 100});
  dds_qset_ignorelocal(quality.get(), DDS_IGNORELOCAL_PARTICIPANT);
  topic_ = dds::entity(dds_create_topic(participant, dds::odometry.descriptor,
                                        dds::dds_name(name_).c_str(), nullptr, nullptr));
  reader_ = dds::entity(dds_create_reader(participant, topic_.get(), quality.get(), nullptr));
}

void odometry_subscription::close() noexcept {
  const std::lock_guard lock(mutex_);
  reader_ = {};
  topic_ = {};
}

void odometry_subscription::take(odometry_path& into, std::int64_t ahead_ns) {
  const std::lock_guard lock(mutex_);
  dds::take_all(reader_, [&](const void* sample, const dds_sample_info_t& about) {
    if (!about.valid_data) return;
    auto odometry = odometry_of(*static_cast<const nav_msgs_msg_dds__Odometry_*>(sample));
    if (!odometry) return;
    odometry->time_ns -= ahead_ns;
    into.add(*odometry);
  });
}

}  // namespace g4_tool
