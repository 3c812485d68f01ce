// SPDX-License-Identifier: MIT
#include "lidar_publisher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "g4lidar/transport/source.hpp"
#include "io/service_source.hpp"

namespace g4_tool {
namespace {

/// Of the topics.
std::string name_space_of(const ros2_options& options, const std::vector<named_source>& lidars) {
  return full_name(options.name_space, options.merges ? "" : lidars.front().name);
}

std::string frame_id_of(const ros2_options& options, const std::vector<named_source>& lidars) {
  return options.merges ? options.frames.robot : frame_of(options, lidars.front().name);
}

service_lidar lidar_of(const ros2_options& options, const common_options& common,
                       const std::string& name) {
  service_lidar made = service_lidar_of(common, options.source);
  made.name = name;
  for (const setting_change& each : options.settings)
    made.settings.emplace_back(each.which->name, g4lidar::value_of(each.value));
  return made;
}

}  // namespace

lidar_publisher::lidar_publisher(dds::bus& bus, const ros2_options& options,
                                 const std::vector<named_source>& lidars, bool is_first)
    : options_(options),
      lidars_(lidars),
      name_space_(name_space_of(options, lidars)),
      is_played_(kind_of_source(lidars.front().source) == source_kind::recording),
      diagnostics_(bus, options, name_space_, options.merges ? "" : lidars.front().name),
      messages_(bus, options, name_space_, frame_id_of(options, lidars)) {
  if (options.merges && options.order == scan_order::time) {
    throw bad_value("--merge cannot be used with --order time: a merged scan has no order of time");
  }
  service_options all = service_options_of(options.common);
  all.merges = options.merges;
  all.restamps = true;  // nobody is to deskew the points of a message again
  all.gives_points = is_played_ || kind_of_source(lidars.front().source) == source_kind::simulated;
  all.is_standby = options.is_standby;
  if (options.common.deskew == deskewing::by_path) {
    all.other_odometry_place = where_odometry_is(options, name_space_);
    all.other_odometry = [this](odometry_path& into, const scan& /*whole*/, std::int64_t ahead_ns) {
      if (driven_) driven_->take(into, ahead_ns);
    };
  }
  std::vector<service_lidar> read;
  read.reserve(lidars.size());
  for (std::size_t i = 0; i < lidars.size(); ++i)
    read.push_back(lidar_of(options, options_of(i), options.merges ? lidars[i].name : ""));
  service_ = make_service(std::move(read), std::move(all), {{this, g4lidar::delivery::in_reader}});
  if (const auto& mount = lidars.front().mount; mount && !options.merges) {
    place_ = publisher_of(bus, options.name_space, options.topics.tf_static,
                          {.type = &dds::tf_message, .depth = 1, .is_for_late = true});
    if (place_) place_->publish(place_message(options, frame_id_of(options, lidars), *mount));
  }
  const bool is_known = service_->has_odometry();
  robot_ = std::make_unique<robot_messages>(bus, options, name_space_,
                                            robot_knowledge{is_known, is_first && is_played_});
  if (options.common.deskew == deskewing::by_path && !is_known && options.topics.odometry != "off")
    driven_ = std::make_unique<odometry_subscription>(
        bus, full_name(name_space_, options.topics.odometry));
}

common_options lidar_publisher::options_of(std::size_t lidar) const {
  common_options made = options_.common;
  made.source = lidars_[lidar].source;
  made.mount = lidars_[lidar].mount;
  return made;
}

std::string lidar_publisher::name_space(std::size_t lidar) const {
  return full_name(options_.name_space, lidars_[lidar].name);
}

void lidar_publisher::start() { value_of(service_->start()); }

std::optional<failure> lidar_publisher::failure_of_any() const {
  for (std::size_t i = 0; i < size(); ++i) {
    if (auto why = final_failure_of(options_of(i), *service_, i)) return why;
  }
  return std::nullopt;
}

std::string lidar_publisher::why_of(std::size_t lidar, const std::optional<error>& why) const {
  return g4_tool::why_of(options_of(lidar), why, service_->counts(lidar));
}

void lidar_publisher::update() {
  const std::chrono::nanoseconds wall = std::chrono::system_clock::now().time_since_epoch();
  diagnostics_.update(
      [this] {
        return service_->diagnosis(
            [this](std::size_t lidar) { return why_of(lidar, service_->status(lidar).why); });
      },
      messages_, is_played_ ? now_ns_.load() : wall.count());
}

service_demand lidar_publisher::wanted() const {
  return {.for_grid = messages_.wants_scan(), .kept = messages_.wants_points()};
}

void lidar_publisher::on_open(std::size_t lidar, g4lidar::lidar& device) {
  logger::verbose(fmt::format("opened {}\n", device.name()));
  if (is_played_) now_ns_ = service_->stamp_ns(lidar, device.player()->begin_ns());
}

void lidar_publisher::on_scan(const service_scan& made) {
  if (made.kept.is_piece()) return;
  if (made.made.for_grid && messages_.wants_scan()) messages_.publish_scan(made);
  if (made.made.kept && messages_.wants_points()) messages_.publish_points(made);
}

void lidar_publisher::on_odometry(const stamped_odometry& now, std::int64_t stamp_ns) {
  robot_->publish(now, stamp_ns);
}

void lidar_publisher::on_time(std::size_t /*lidar*/, std::int64_t stamp_ns) {
  now_ns_ = std::max(now_ns_.load(), stamp_ns);
  robot_->publish_clock(stamp_ns);
}

void lidar_publisher::on_motion(bool is_known, const std::string& why) {
  report_motion(is_known, why);
}

void lidar_publisher::on_event(std::size_t lidar, const lidar_event& what,
                               std::int64_t /*stamp_ns*/) {
  logger::info(fmt::format("{}: {}\n", service_->status(lidar).name, name_of(what.what)));
}

void lidar_publisher::on_state(std::size_t lidar, reader_state state,
                               const std::optional<error>& why) {
  std::string text = why_of(lidar, why);
  // The failure of the only lidar is reported at the end of the program.
  if (state == reader_state::ended && options_.sources.size() <= 1) text.clear();
  const std::string& name = lidars_[lidar].name;
  logger::info(fmt::format("{}{}: {}{}{}\n", name.empty() ? "lidar" : "lidar ", name,
                           name_of(state), text.empty() ? "" : ". ", text));
}

void lidar_publisher::on_values(std::size_t lidar, const std::string& refused) {
  const std::string& name = lidars_[lidar].name;
  if (!refused.empty())
    logger::info((name.empty() ? "" : name + ": ") + in_tool_words(refused) + "\n");
}

}  // namespace g4_tool
