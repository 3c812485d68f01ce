// SPDX-License-Identifier: MIT
#include "g4lidar_ros/lidar_node.hpp"

#include <chrono>
#include <exception>
#include <functional>
#include <utility>

#include <lifecycle_msgs/msg/state.hpp>
#include <rclcpp_components/register_node_macro.hpp>

#include "lidar_session.hpp"
#include "node_diagnostics.hpp"
#include "node_parameters.hpp"

namespace g4lidar_ros {
namespace {

using namespace std::chrono_literals;
using lifecycle_msgs::msg::State;

/// So long deactivate waits until the motor rests.
constexpr auto rest_time = 2s;

}  // namespace

LidarNode::LidarNode(const rclcpp::NodeOptions& options)
    : LifecycleNode("g4lidar", options),
      parameters_(std::make_unique<node_parameters>(*this)),
      diagnostics_(std::make_unique<node_diagnostics>(*this)),
      starts_itself_(parameters_->starts_itself()) {
  // As ~/start and ~/stop, with every middleware of the one who publishes.
  rclcpp::SubscriptionOptions how;
  how.qos_overriding_options = rclcpp::QosOverridingOptions::with_default_policies();
  running_ = create_subscription<std_msgs::msg::Bool>(
      "~/run", rclcpp::QoS(10).reliable(),
      [this](const std_msgs::msg::Bool& wanted) {
        trigger::Response answer;
        allow(wanted.data, answer);
        RCLCPP_INFO(get_logger(), "~/run: %s: %s", wanted.data ? "true" : "false",
                    answer.message.c_str());
      },
      how);
  const auto offer = [this](const char* name, bool runs) {
    services_.push_back(create_service<trigger>(
        name, [this, runs](const trigger::Request::SharedPtr&,
                           const trigger::Response::SharedPtr& answer) { allow(runs, *answer); }));
  };
  offer("~/start", true);
  offer("~/stop", false);
  timer_ = create_wall_timer(100ms, [this] { update(); });
}

LidarNode::~LidarNode() {
  timer_.reset();
  running_.reset();
  diagnostics_.reset();
  parameters_.reset();
  session_.reset();
}

void LidarNode::open() {
  if (session_) return;
  const session_options how = parameters_->for_session();
  if (!topics_) topics_ = std::make_unique<lidar_topics>(*this);
  const auto made = std::make_shared<lidar_session>(*this, *topics_, how);
  if (const auto started = made->start(); !started)
    throw std::runtime_error(started.error().message());
  session_ = made;
}

LidarNode::CallbackReturn LidarNode::on_configure(const rclcpp_lifecycle::State& /*previous*/) {
  try {
    open();
  } catch (const std::exception& wrong) {
    RCLCPP_ERROR(get_logger(), "%s", wrong.what());
    return CallbackReturn::ERROR;
  }
  const auto longest = parameters_->connect_timeout();
  if (longest > 0ns && !session_->wait_until_open(longest)) {
    const auto [state, why, information, name, playback] = session_->status();
    RCLCPP_ERROR(get_logger(), "not configured: %s",
                 why ? why->message().c_str() : "the lidar did not open in time");
    on_cleanup(get_current_state());
    const bool may_come = state != g4lidar::reader_state::ended;
    return may_come ? CallbackReturn::FAILURE : CallbackReturn::ERROR;
  }
  diagnostics_->follow(session_);
  parameters_->follow(session_);
  return CallbackReturn::SUCCESS;
}

LidarNode::CallbackReturn LidarNode::on_activate(const rclcpp_lifecycle::State& previous) {
  session_->restart_file();
  if (session_->failure()) return CallbackReturn::ERROR;
  is_allowed_ = true;
  standby_ = {};
  const CallbackReturn done = LifecycleNode::on_activate(previous);  // activates the publishers
  if (!parameters_->is_standby()) session_->rest(false);
  return done;
}

LidarNode::CallbackReturn LidarNode::on_deactivate(const rclcpp_lifecycle::State& previous) {
  session_->rest(true, rest_time);
  const CallbackReturn done = LifecycleNode::on_deactivate(previous);
  return session_->failure() ? CallbackReturn::ERROR : done;
}

LidarNode::CallbackReturn LidarNode::on_cleanup(const rclcpp_lifecycle::State& /*previous*/) {
  diagnostics_->follow(nullptr);
  parameters_->follow(nullptr);
  session_.reset();
  return CallbackReturn::SUCCESS;
}

LidarNode::CallbackReturn LidarNode::on_shutdown(const rclcpp_lifecycle::State& previous) {
  return on_cleanup(previous);
}

LidarNode::CallbackReturn LidarNode::on_error(const rclcpp_lifecycle::State& previous) {
  return on_cleanup(previous);
}

bool LidarNode::is_opening() {
  if (!session_) {
    try {
      open();
    } catch (const std::exception&) {
      return false;  // configure() reports it
    }
    diagnostics_->follow(session_);
    parameters_->follow(session_);
    late_at_ = std::chrono::steady_clock::now() + parameters_->connect_timeout();
  }
  const auto now = session_->status();
  const bool is_opening = now.state == g4lidar::reader_state::opening;
  if (is_opening && late_at_ && std::chrono::steady_clock::now() >= *late_at_) {
    late_at_.reset();  // once
    RCLCPP_ERROR(get_logger(), "not configured before there is a lidar: %s",
                 now.why ? now.why->message().c_str() : "it did not open in time");
  }
  return is_opening;
}

void LidarNode::start_itself() {
  // A lidar may be plugged in later. Waiting for it in configure would keep other nodes of the process from running.
  if (parameters_->connect_timeout() > 0ns && is_opening()) return;
  starts_itself_ = false;  // what is wrong with a parameter stays so
  if (configure().id() == State::PRIMARY_STATE_INACTIVE) activate();
}

void LidarNode::update() {
  if (starts_itself_) return start_itself();
  parameters_->update();
  if (!session_ || get_current_state().id() != State::PRIMARY_STATE_ACTIVE) return;
  if (const auto why = session_->failure()) {
    RCLCPP_ERROR(get_logger(), "deactivated: %s", why->message().c_str());
    deactivate();
    return;
  }
  if (session_->status().state == g4lidar::reader_state::ended) {
    RCLCPP_INFO(get_logger(), "the recording is at its end; activate it again to repeat it");
    deactivate();
    return;
  }
  const bool is_needed = !parameters_->is_standby() || session_->is_wanted();
  const bool rests = standby_.rests(is_needed, std::chrono::steady_clock::now());
  session_->rest(rests || !is_allowed_);
}

void LidarNode::allow(bool runs, trigger::Response& answer) {
  answer.success = get_current_state().id() == State::PRIMARY_STATE_ACTIVE;
  if (!answer.success) {
    answer.message = "the node is not active";
    return;
  }
  is_allowed_ = runs;
  update();
  if (!runs)
    answer.message = "the motor rests until start is called";
  else if (parameters_->is_standby())
    answer.message = "the motor turns while somebody subscribes";
  else
    answer.message = "the motor turns";
}

}  // namespace g4lidar_ros

RCLCPP_COMPONENTS_REGISTER_NODE(g4lidar_ros::LidarNode)
