// SPDX-License-Identifier: MIT
#include "g4lidar_ros/lidar_node.hpp"

#include <chrono>
#include <exception>
#include <stdexcept>
#include <utility>

#include <lifecycle_msgs/msg/state.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <std_srvs/srv/empty.hpp>
#if defined(G4LIDAR_ROS_BOND)
#include <bondcpp/bond.hpp>
#endif

#include "lidar_session.hpp"
#include "node_diagnostics.hpp"
#include "node_parameters.hpp"

namespace g4lidar_ros {
namespace {

using namespace std::chrono_literals;
using lifecycle_msgs::msg::State;

/// So long deactivate waits until the motor rests.
constexpr auto rest_time = 2s;

/// As the nodes of Nav2, whose lifecycle manager is the other end.
std::shared_ptr<void> bond_of([[maybe_unused]] LidarNode& node, [[maybe_unused]] double period_s) {
#if defined(G4LIDAR_ROS_BOND)
  constexpr double longest_silence_s = 4.0;
  const auto made = std::make_shared<bond::Bond>("bond", node.get_name(), node.shared_from_this());
  made->setHeartbeatPeriod(period_s);
  made->setHeartbeatTimeout(longest_silence_s);
  made->start();
  return made;
#else
  throw std::invalid_argument("bond_heartbeat_period: this was compiled without bondcpp");
#endif
}

}  // namespace

LidarNode::LidarNode(const rclcpp::NodeOptions& options)
    : LifecycleNode("g4lidar", options),
      parameters_(std::make_unique<node_parameters>(*this)),
      diagnostics_(std::make_unique<node_diagnostics>(*this)),
      starts_itself_(get_parameter("autostart").as_bool()) {
  // As ~/start and ~/stop, with every middleware of the one who publishes.
  rclcpp::SubscriptionOptions how;
  how.qos_overriding_options = rclcpp::QosOverridingOptions::with_default_policies();
  running_ = create_subscription<std_msgs::msg::Bool>(
      "~/run", rclcpp::QoS(10).reliable(),
      [this](const std_msgs::msg::Bool& wanted) {
        allow(wanted.data, wanted.data ? "~/run: true" : "~/run: false");
      },
      how);
  using std_srvs::srv::Empty;
  for (const bool runs : {true, false}) {
    services_.push_back(create_service<trigger>(
        runs ? "~/start" : "~/stop",
        [this, runs](const trigger::Request::SharedPtr&,
                     const trigger::Response::SharedPtr& answer) { allow(runs, *answer); }));
    // Those of ydlidar_ros2_driver and of sllidar_ros2.
    for (const char* const what : {"scan", "motor"}) {
      const std::string name = std::string(runs ? "start_" : "stop_") + what;
      services_.push_back(create_service<Empty>(
          name, [this, runs, name](const Empty::Request::SharedPtr&,
                                   const Empty::Response::SharedPtr&) { allow(runs, name); }));
    }
  }
  timer_ = create_wall_timer(100ms, [this] { update(); });
}

LidarNode::~LidarNode() = default;

LidarNode::CallbackReturn LidarNode::on_configure(const rclcpp_lifecycle::State& /*previous*/) {
  try {
    session_options how = parameters_->for_session();
    if (!topics_) topics_ = std::make_unique<lidar_topics>(*this);
    session_ = std::make_shared<lidar_session>(*this, *topics_, std::move(how));
    if (const auto started = session_->start(); !started)
      throw std::runtime_error(started.error().message());
  } catch (const std::exception& wrong) {
    if (get_node_base_interface()->get_context()->is_valid())  // else the program ends
      RCLCPP_ERROR(get_logger(), "not configured: %s", wrong.what());
    return CallbackReturn::ERROR;
  }
  diagnostics_->follow(session_);
  parameters_->follow(session_);
  return session_->failure() ? CallbackReturn::ERROR : CallbackReturn::SUCCESS;
}

LidarNode::CallbackReturn LidarNode::on_activate(const rclcpp_lifecycle::State& previous) {
  session_->restart_file();
  if (session_->failure()) return CallbackReturn::ERROR;
  session_->set_standby(get_parameter("standby").as_bool());
  if (const double period_s = get_parameter("bond_heartbeat_period").as_double(); period_s > 0)
    bond_ = bond_of(*this, period_s);
  const CallbackReturn done = LifecycleNode::on_activate(previous);  // activates the publishers
  session_->allow(true);
  return done;
}

LidarNode::CallbackReturn LidarNode::on_deactivate(const rclcpp_lifecycle::State& previous) {
  bond_.reset();
  session_->allow(false, rest_time);
  const CallbackReturn done = LifecycleNode::on_deactivate(previous);
  return session_->failure() ? CallbackReturn::ERROR : done;
}

LidarNode::CallbackReturn LidarNode::on_cleanup(const rclcpp_lifecycle::State& /*previous*/) {
  bond_.reset();
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

void LidarNode::update() {
  // What is wrong with a parameter stays so: it is not tried again.
  if (std::exchange(starts_itself_, false) && configure().id() == State::PRIMARY_STATE_INACTIVE) {
    activate();
  }
  parameters_->update();
  const bool is_active = get_current_state().id() == State::PRIMARY_STATE_ACTIVE;
  if (!session_) return;
  if (const auto why = session_->failure()) {
    RCLCPP_ERROR(get_logger(), "unconfigured: %s", why->message().c_str());
    is_active ? deactivate() : cleanup();
    return;
  }
  session_->set_standby(get_parameter("standby").as_bool());
  if (!is_active || !session_->has_ended()) return;
  RCLCPP_INFO(get_logger(), "the recording is at its end; activate it again to repeat it");
  deactivate();
}

void LidarNode::allow(bool runs, trigger::Response& answer) {
  answer.success = get_current_state().id() == State::PRIMARY_STATE_ACTIVE;
  if (!answer.success) {
    answer.message = "the node is not active";
    return;
  }
  session_->allow(runs);
  if (!runs)
    answer.message = "the motor rests until start is called";
  else if (get_parameter("standby").as_bool())
    answer.message = "the motor turns while somebody subscribes";
  else
    answer.message = "the motor turns";
}

void LidarNode::allow(bool runs, const std::string& cause) {
  trigger::Response answer;
  allow(runs, answer);
  RCLCPP_INFO(get_logger(), "%s: %s", cause.c_str(), answer.message.c_str());
}

}  // namespace g4lidar_ros

RCLCPP_COMPONENTS_REGISTER_NODE(g4lidar_ros::LidarNode)
