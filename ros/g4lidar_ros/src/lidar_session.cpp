// SPDX-License-Identifier: MIT
#include "lidar_session.hpp"

#include <functional>
#include <stdexcept>
#include <utility>

#include "g4lidar/transport/source.hpp"

namespace g4lidar_ros {
namespace {

using namespace std::chrono_literals;
using g4lidar::reader_state;
using g4lidar::source_kind;

/// The time of stamps minus that of points, which is negative where the time of /clock is less than that since the
/// machine was started. Nothing before the first /clock, if it is used.
std::optional<std::int64_t> ahead_by(rclcpp::Clock& clock, std::int64_t wall_ahead_ns) {
  if (!clock.ros_time_is_active()) return wall_ahead_ns;
  const std::int64_t now_ns = clock.now().nanoseconds();
  if (now_ns == 0) return std::nullopt;  // there is no /clock yet
  const std::chrono::nanoseconds wall = std::chrono::system_clock::now().time_since_epoch();
  return wall_ahead_ns + now_ns - wall.count();
}

/// So long a change of settings may take; the lidar stops and starts for it.
constexpr auto change_time = 10s;

}  // namespace

lidar_session::lidar_session(rclcpp_lifecycle::LifecycleNode& node, lidar_topics& topics,
                             session_options options)
    : node_(node),
      topics_(topics),
      options_(std::move(options)),
      is_file_(g4lidar::names_file(options_.lidars.front().options.device)),
      motion_(node, topics, options_.motion) {
  const std::string& source = options_.lidars.front().options.device;
  g4lidar::service_options& how = options_.service;
  how.gives_points = is_file_ || g4lidar::has_simulated_robot(source);
  how.stamp_clock = [this, clock = node.get_clock()](std::int64_t wall_ahead_ns) {
    std::optional<std::int64_t> made;
    guard(node_, [&] { made = ahead_by(*clock, wall_ahead_ns); });
    return made;
  };
  how.other_odometry = std::bind_front(&odometry_publisher::take, &motion_);
  constexpr auto by = g4lidar::delivery::in_reader;
  auto made =
      g4lidar::lidar_service::make(options_.lidars, std::move(how), {{&motion_, by}, {this, by}});
  if (!made) throw std::invalid_argument(made.error().message());
  service_ = std::move(*made);
  if (const std::string wrong = service_->change_now(0, options_.filters); !wrong.empty())
    throw std::invalid_argument(wrong);
  motion_.connect(options_.frame_id, service_->has_odometry());
  if (!topics.clock && g4lidar::kind_of_source(source) == source_kind::recording) {
    topics.clock = std::make_unique<counted_publisher<rosgraph_msgs::msg::Clock>>(
        node, "/clock", rclcpp::QoS(10).reliable());
  }
  if (options_.order == g4lidar::scan_order::time) {
    RCLCPP_WARN(
        node.get_logger(),
        "order: time is not for slam_toolbox, which would make a wrong map; it needs angle");
  }
  // The motor rests at once, also in a container whose other components take their time.
  before_shutdown_ =
      node.get_node_base_interface()->get_context()->add_pre_shutdown_callback([this] {
        service_->allow(false);
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
        changed_.notify_all();
      });
}

lidar_session::~lidar_session() {
  node_.get_node_base_interface()->get_context()->remove_pre_shutdown_callback(before_shutdown_);
  service_->stop();
}

std::string lidar_session::named(std::size_t lidar, const std::string& text) const {
  const std::string& name = options_.lidars[lidar].name;
  return name.empty() ? text : name + ": " + text;
}

template <class Condition>
void lidar_session::wait(std::chrono::nanoseconds longest, Condition condition) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, longest, [&] { return is_ending_ || condition(); });
}

template <class Condition>
bool lidar_session::is_each(Condition condition) const {
  for (std::size_t i = 0; i < service_->size(); ++i) {
    if (!condition(i, service_->status(i).state)) return false;
  }
  return true;
}

g4lidar::result<void> lidar_session::start() {
  service_->allow(false);
  const auto started = service_->start();
  if (!started) return started;
  const auto is_tried = [this](std::size_t lidar, reader_state state) {
    const std::string& source = options_.lidars[lidar].options.device;
    return state != reader_state::opening || g4lidar::kind_of_source(source) == source_kind::device;
  };
  wait(1s, [&] { return is_each(is_tried); });
  return started;
}

void lidar_session::allow(bool runs, std::chrono::nanoseconds longest) {
  service_->allow(runs);
  if (runs || longest == 0ns) return;
  wait(longest, [this] {
    return is_each(
        [](std::size_t /*lidar*/, reader_state state) { return state != reader_state::running; });
  });
}

std::string lidar_session::change(std::size_t lidar,
                                  const std::vector<g4lidar::named_value>& wanted) {
  const auto reply = std::make_shared<std::optional<std::string>>();
  service_->change(
      lidar, wanted,
      [this, reply](const std::string& why_not) {
        const std::lock_guard lock(mutex_);
        *reply = why_not;
        changed_.notify_all();
      },
      change_time);
  std::string why_not = "the lidar did not answer in time; it may be set later";
  wait(2 * change_time, [&] {
    if (*reply) why_not = **reply;
    return reply->has_value();
  });
  return why_not.empty() ? why_not : named(lidar, why_not);
}

std::string lidar_session::change(const std::vector<g4lidar::named_value>& wanted) {
  std::vector<std::vector<g4lidar::named_value>> before;
  for (std::size_t i = 0; i < service_->size(); ++i) {
    auto& here = before.emplace_back();
    for (const auto& [name, value] : wanted) {
      g4lidar::parameter_value known = service_->value(i, *g4lidar::find_parameter(name));
      if (known.index() != 0) here.emplace_back(name, std::move(known));
    }
    const std::string why_not = change(i, wanted);
    if (why_not.empty()) continue;
    for (std::size_t done = 0; done < i; ++done) static_cast<void>(change(done, before[done]));
    return why_not;
  }
  return {};
}

g4lidar::parameter_value lidar_session::known(const g4lidar::parameter& row) const {
  g4lidar::parameter_value first = service_->value(0, row);
  for (std::size_t i = 1; i < service_->size(); ++i) {
    if (service_->value(i, row) != first) return {};
  }
  return first;
}

void lidar_session::restart_file() {
  if (!is_file_ || !has_ended()) return;
  service_->seek(0);
  // Until then it is still at the end, at which the node deactivates itself.
  wait(change_time, [this] { return failure() || !has_ended(); });
}

std::optional<g4lidar::error> lidar_session::failure() const {
  return has_ended() ? service_->failure_of(0) : std::nullopt;
}

g4lidar::service_demand lidar_session::wanted() const {
  g4lidar::service_demand made{.for_grid = false, .kept = false, .runs = !is_standby_};
  guard(node_, [&] {
    made.for_grid = topics_.scans.is_wanted();
    made.kept = topics_.clouds.is_wanted();
  });
  return made;
}

void lidar_session::on_open(std::size_t lidar, g4lidar::lidar& device) {
  RCLCPP_INFO(node_.get_logger(), "%s",
              named(lidar, "opened " + std::string(device.name())).c_str());
}

void lidar_session::on_values(std::size_t lidar, const std::string& refused) {
  if (!refused.empty()) RCLCPP_WARN(node_.get_logger(), "%s", named(lidar, refused).c_str());
  is_news_ = true;
}

void lidar_session::on_scan(const g4lidar::service_scan& made) {
  if (made.kept.is_piece()) return;
  guard(node_, [&] {
    g4lidar::message_header header{.stamp_ns = made.stamp_ns(made.first_ns),
                                   .frame_id = options_.frame_id,
                                   .duration_ns = made.duration_ns,
                                   .order = options_.order,
                                   .model = made.kept.model};
    if (made.made.for_grid && topics_.scans.is_wanted()) {
      const std::size_t bins = options_.bins.value_or(g4lidar::default_bins(*header.model));
      topics_.scans.publish(laser_scan_of(made.for_grid, header, made.grid, bins));
    }
    if (!made.made.kept || !topics_.clouds.is_wanted()) return;
    if (!made.kept.empty())
      header.stamp_ns = made.stamp_ns(g4lidar::cloud_time_ns(made.kept.points));
    topics_.clouds.publish(cloud_of(made.kept, header));
  });
}

void lidar_session::on_event(std::size_t lidar, const g4lidar::lidar_event& event,
                             std::int64_t /*stamp_ns*/) {
  RCLCPP_INFO(node_.get_logger(), "%s",
              named(lidar, "event: " + std::string(g4lidar::name_of(event.what))).c_str());
}

void lidar_session::on_state(std::size_t lidar, reader_state state,
                             const std::optional<g4lidar::error>& why) {
  const auto failed = why ? service_->failure_of(lidar) : std::nullopt;
  const bool is_bad = failed.has_value();
  const std::string text =
      named(lidar, std::string(name_of(state)) + (is_bad ? ": " + failed->message() : ""));
  const rclcpp::Logger logger = node_.get_logger();
  if (is_bad && state == reader_state::ended)
    RCLCPP_ERROR(logger, "%s", text.c_str());
  else if (is_bad)
    RCLCPP_WARN(logger, "%s", text.c_str());
  else
    RCLCPP_INFO(logger, "%s", text.c_str());
  const std::lock_guard lock(mutex_);
  changed_.notify_all();
}

}  // namespace g4lidar_ros
