// SPDX-License-Identifier: MIT
#include "lidar_session.hpp"

#include <cstdlib>
#include <exception>
#include <future>
#include <stdexcept>
#include <utility>
#include <variant>

#include "g4lidar/export/mask.hpp"
#include "g4lidar/source.hpp"

namespace g4lidar_ros {
namespace {

using namespace std::chrono_literals;
using g4lidar::reader_state;

bool is_file_name(const std::string& source) {
  const g4lidar::source_kind kind = g4lidar::kind_of_source(source);
  return kind == g4lidar::source_kind::recording || kind == g4lidar::source_kind::raw_bytes;
}

std::int64_t wall_now_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// So long a change of settings may take; the lidar stops and starts for it.
constexpr auto change_time = 10s;

/// The mask in this file. Throws std::invalid_argument.
g4lidar::mask mask_in(const std::string& path) {
  auto made = g4lidar::load_mask(path);
  if (const auto* wrong = std::get_if<std::string>(&made)) throw std::invalid_argument(*wrong);
  return std::get<g4lidar::mask>(std::move(made));
}

}  // namespace

lidar_session::lidar_session(rclcpp_lifecycle::LifecycleNode& node, lidar_topics& topics,
                             const session_options& options)
    : node_(node),
      topics_(topics),
      options_(options),
      is_file_(is_file_name(options.lidar.device)),
      motion_(node, topics, options.motion, options.frame_id, options.lidar.device),
      parameters_(options.shaping, {.filter = {.in = g4lidar::frame::robot}}, mask_in(options.mask),
                  shaper_),
      reader_(
          [this] {
            g4lidar::lidar_options made = g4lidar::usable_options(options_.lidar);
            made.wrap = [this](std::unique_ptr<g4lidar::connector> from) {
              simulation_ = g4lidar::simulation_of(*from);
              return g4lidar::result<std::unique_ptr<g4lidar::connector>>(
                  diagnosis_.observe(std::move(from)));
            };
            return made;
          }(),
          {.wants_points = is_file_ || motion_.has_odometry(), .starts_rested = true}, this) {
  if (!topics.clock &&
      g4lidar::kind_of_source(options.lidar.device) == g4lidar::source_kind::recording) {
    topics.clock = std::make_unique<counted_publisher<rosgraph_msgs::msg::Clock>>(
        node, "/clock", rclcpp::QoS(10).reliable());
  }
  if (const std::string wrong = parameters_.change(nullptr, options.filters); !wrong.empty())
    throw std::invalid_argument(wrong);
  wanted_.insert(options.settings.begin(), options.settings.end());
  if (options.order == g4lidar::scan_order::time) {
    RCLCPP_WARN(
        node.get_logger(),
        "order: time is not for slam_toolbox, which would make a wrong map; it needs angle");
  }
  // The motor rests at once, also in a container whose other components take their time.
  before_shutdown_ =
      node.get_node_base_interface()->get_context()->add_pre_shutdown_callback([this] {
        reader_.rest(true);
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
        changed_.notify_all();
      });
}

lidar_session::~lidar_session() {
  node_.get_node_base_interface()->get_context()->remove_pre_shutdown_callback(before_shutdown_);
  reader_.stop();
}

template <class Call>
void lidar_session::guard(Call call) noexcept {
  try {
    call();
  } catch (const std::exception& failure) {
    RCLCPP_ERROR_THROTTLE(node_.get_logger(), *node_.get_clock(), 5000, "%s", failure.what());
  }
}

g4lidar::result<void> lidar_session::start() {
  auto started = reader_.start();
  const auto kind = g4lidar::kind_of_source(options_.lidar.device);
  if (!started || kind == g4lidar::source_kind::device) return started;
  std::unique_lock lock(mutex_);
  changed_.wait_for(
      lock, 1s, [this] { return is_ending_ || reader_.status().state != reader_state::opening; });
  return started;
}

void lidar_session::rest(bool rests, std::chrono::nanoseconds longest) {
  reader_.rest(rests);
  if (!rests || longest == 0ns) return;
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, longest,
                    [this] { return reader_.status().state != reader_state::running; });
}

std::string lidar_session::change(const std::vector<g4lidar::named_value>& settings) {
  struct request {
    std::atomic_flag is_taken;  // by the one who answers it: the reader, or this function
    std::promise<std::string> reply;
  };
  const auto made = std::make_shared<request>();
  auto answered = made->reply.get_future();
  reader_.ask([this, made, settings](g4lidar::lidar* lidar) {
    if (made->is_taken.test_and_set()) return;
    std::string reason = "it could not be set";
    guard([&] { reason = set(lidar, settings); });
    made->reply.set_value(reason);
  });
  const auto end = std::chrono::steady_clock::now() + change_time;
  while (!is_ending_ && std::chrono::steady_clock::now() < end) {
    if (answered.wait_for(20ms) == std::future_status::ready) return answered.get();
    // The reader searches the lidar, and may do so for long.
    const bool is_searched = reader_.status().state == reader_state::opening;
    if (is_searched && !made->is_taken.test_and_set()) return "the lidar is not connected";
  }
  return "the lidar did not answer in time; it may be set later";
}

std::string lidar_session::set(g4lidar::lidar* device,
                               const std::vector<g4lidar::named_value>& settings) {
  std::string wrong = parameters_.change(device, settings);
  if (!wrong.empty()) return wrong;
  for (const auto& [name, value] : settings) wanted_.insert_or_assign(name, value);
  is_news_ = true;
  return wrong;
}

void lidar_session::filter(std::vector<g4lidar::named_value> filters) {
  reader_.ask([this, what = std::move(filters)](g4lidar::lidar* /*lidar*/) {
    guard([&] { static_cast<void>(parameters_.change(nullptr, what)); });
  });
}

void lidar_session::restart_file() {
  if (!is_file_ || reader_.status().state != reader_state::ended) return;
  reader_.seek(0);
  // Until then it is still at the end, at which the node deactivates itself.
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, change_time, [this] {
    return is_ending_ || failure() || reader_.status().state != reader_state::ended;
  });
}

std::optional<g4lidar::error> lidar_session::failure() const {
  const g4lidar::reader_status now = reader_.status();
  if (now.state != reader_state::ended || !now.why) return std::nullopt;
  if (is_file_ && *now.why == g4lidar::problem::end_of_input) return std::nullopt;
  return now.why;
}

std::optional<std::int64_t> lidar_session::ahead_ns() const {
  const std::int64_t wall_ahead_ns = reader_.wall_ns(0);
  const rclcpp::Clock::SharedPtr clock = node_.get_clock();
  if (is_file_ || !clock->ros_time_is_active()) return wall_ahead_ns;
  const std::int64_t now_ns = clock->now().nanoseconds();
  if (now_ns == 0) return std::nullopt;  // there is no /clock yet
  return wall_ahead_ns + now_ns - wall_now_ns();
}

std::int64_t lidar_session::stamp_ns(std::int64_t time_ns) const {
  const auto ahead = ahead_ns();
  return ahead ? stamp_of(time_ns, *ahead) : 0;
}

void lidar_session::on_open(g4lidar::lidar& device) {
  guard([&] {
    RCLCPP_INFO(node_.get_logger(), "opened %s", std::string(device.name()).c_str());
    motion_.follow(device, simulation_);
    if (is_file_) return;
    if (device.information().is_known())
      parameters_.fix("serial_number", std::string(device.information().serial_number()));
    parameters_.read_device(device);
    // The options are those of the beginning; and what is set now is known before the scan.
    std::vector<g4lidar::named_value> missing;
    for (const auto& [name, value] : wanted_) {
      if (parameters_.value(*g4lidar::find_parameter(name)) != value)
        missing.emplace_back(name, value);
    }
    if (const std::string wrong = set(&device, missing); !wrong.empty())
      RCLCPP_WARN(node_.get_logger(), "%s", wrong.c_str());
    is_news_ = true;  // also if that has failed
  });
}

void lidar_session::on_points(std::span<const g4lidar::point> points) {
  guard([&] {
    motion_.follow(points, ahead_ns());
    publish_clock(stamp_ns(points.back().time_ns));
  });
}

void lidar_session::publish_clock(std::int64_t now_ns) {
  constexpr std::int64_t clock_step_ns = 10'000'000;
  if (!topics_.clock || !topics_.clock->is_wanted() || std::abs(now_ns - clock_ns_) < clock_step_ns)
    return;
  clock_ns_ = now_ns;
  auto made = std::make_unique<rosgraph_msgs::msg::Clock>();
  made->clock = rclcpp::Time(now_ns);
  topics_.clock->publish(std::move(made));
}

void lidar_session::on_scan(const g4lidar::scan& whole) {
  if (whole.is_piece()) return;
  guard([&] { publish(whole); });
}

void lidar_session::publish(const g4lidar::scan& whole) {
  shaper_.shape(whole, motion_.path_of(whole, ahead_ns()));
  not_deskewed_ = shaper_.points_not_deskewed();
  g4lidar::message_header header{.stamp_ns = stamp_ns(whole.time_ns()),
                                 .frame_id = options_.frame_id,
                                 .duration_ns = whole.duration_ns,
                                 .order = options_.order,
                                 .model = whole.model};
  if (topics_.scans.is_wanted()) {
    const std::size_t bins = options_.bins.value_or(g4lidar::default_bins(*whole.model));
    topics_.scans.publish(
        laser_scan_of(shaper_.for_grid(), header, parameters_.filters().grid, bins));
  }
  if (!topics_.clouds.is_wanted()) return;
  const g4lidar::scan kept = shaper_.kept();
  if (!kept.empty()) header.stamp_ns = stamp_ns(kept.time_ns());
  topics_.clouds.publish(cloud_of(kept, header));
}

void lidar_session::on_event(const g4lidar::lidar_event& what) {
  diagnosis_.add(what);
  guard([&] {
    const std::string name(g4lidar::name_of(what.what));
    RCLCPP_INFO(node_.get_logger(), "event: %s", name.c_str());
  });
}

void lidar_session::on_state(reader_state state, const std::optional<g4lidar::error>& why) {
  guard([&] {
    if (why && state != reader_state::lost && why->doing() == g4lidar::task::reading)
      diagnosis_.add(*why);
    const bool is_end = why && is_file_ && *why == g4lidar::problem::end_of_input;
    const std::string text =
        std::string(name_of(state)) + (why && !is_end ? ": " + why->message() : "");
    const rclcpp::Logger logger = node_.get_logger();
    if (state == reader_state::ended && !is_end)
      RCLCPP_ERROR(logger, "%s", text.c_str());
    else if (why && !is_end)
      RCLCPP_WARN(logger, "%s", text.c_str());
    else
      RCLCPP_INFO(logger, "%s", text.c_str());
  });
  const std::lock_guard lock(mutex_);
  changed_.notify_all();
}

}  // namespace g4lidar_ros
