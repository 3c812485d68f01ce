// SPDX-License-Identifier: MIT
#include "lidar_node.hpp"

#include <fmt/format.h>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "merger.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;

/// How long the motor runs after the last subscriber has left, so that one that returns need not wait.
constexpr auto rest_delay = 3s;

common_options options_of(const ros2_options& options, const named_source& which) {
  common_options made = options.common;
  made.source = which.source;
  made.mount = which.mount;
  return made;
}

}  // namespace

lidar_node::lidar_node(dds::bus& on, const ros2_options& options, const named_source& which,
                       merger* into, std::size_t index)
    : options_(options),
      which_(which),
      name_space_(which.name.empty() ? full_name(options.name_space, "")
                                     : full_name(options.name_space, which.name)),
      merger_(into),
      index_(index),
      diagnostics_(on, options, name_space_, which.name),
      parameters_(options_of(options, which), options.filter_words, into != nullptr, shaper_) {
  const std::string frame_id = frame_of(options, which.name);
  parameters_.fix("frame_id", merger_ == nullptr ? frame_id : options.frames.robot);
  parameters_.fix("grid", std::int64_t{options.bins});
  parameters_.fix("order", options.order == scan_order::time ? "time" : "angle");
  if (merger_ == nullptr) {
    messages_ = std::make_unique<scan_messages>(on, options, name_space_, frame_id);
  }
  if (which.mount && merger_ == nullptr) {
    place_ = publisher_of(on, options.name_space, options.topics.tf_static,
                          {.type = &dds::tf_message, .depth = 1, .is_for_late = true});
    if (place_) place_->publish(place_message(options, frame_id, *which.mount));
  }
  const bool is_by_path = options.common.deskew == deskewing::by_path && merger_ == nullptr;
  const bool is_played = kind_of_source(which.source) == source_kind::recording;
  if (is_played) {
    feed_.load_recording(path_of_source(which.source));
    time_.emplace();
  }
  // Merged lidars have one robot, which belongs to the first lidar.
  if (merger_ == nullptr || index == 0) {
    const bool is_known =
        feed_.is_known() || kind_of_source(which.source) == source_kind::simulated;
    robot_.emplace(on, options, merger_ == nullptr ? name_space_ : options.name_space,
                   robot_knowledge{is_known, index == 0 && is_played});
  }
  if (is_by_path && !feed_.is_known() && options.topics.odometry != "off") {
    driven_ = std::make_unique<odometry_subscription>(
        on, full_name(name_space_, options.topics.odometry));
  }
  if (options.common.deskew != deskewing::none && merger_ == nullptr) {
    report_ = std::make_unique<deskew_report>(
        options.common.deskew,
        feed_.is_known() ? "in the recording" : where_odometry_is(options, name_space_));
    also_report([this] { return report_->status(); });
  }
  station_options wishes = options.station;
  wishes.starts_rested = options.is_standby;
  wishes.wants_points =
      is_played || (robot_ && kind_of_source(which.source) == source_kind::simulated);
  station_ = std::make_unique<station>(options_of(options, which), options.source, *this, wishes);
}

lidar_node::~lidar_node() = default;

bool lidar_node::is_wanted() const {
  return merger_ == nullptr ? messages_->is_wanted() : merger_->is_wanted();
}

void lidar_node::update() {
  const auto now = clock::now();
  if (!options_.is_standby || is_wanted()) wanted_ = now;
  station_->rest(!is_allowed_ || now - wanted_ > rest_delay);
  const std::chrono::nanoseconds wall = std::chrono::system_clock::now().time_since_epoch();
  diagnostics_.update(*station_, messages_ ? *messages_ : merger_->messages(),
                      time_ ? time_->now_ns() : wall.count());
}

void lidar_node::change(std::vector<named_value> wanted, std::function<void(std::string)> done) {
  station_->ask([this, what = std::move(wanted), after = std::move(done)](g4lidar::lidar* lidar) {
    after(parameters_.change(lidar, what));
  });
}

std::int64_t lidar_node::stamp_ns(std::int64_t time_ns) const {
  const std::int64_t wall_ns = station_->wall_ns(time_ns);
  return time_ ? time_->stamp_ns(wall_ns) : wall_ns;
}

void lidar_node::on_open(opened_source& source) {
  feed_.restart();
  if (time_ && source.recording() != nullptr) {
    time_->begin(station_->wall_ns(source.recording()->first_ns()));
  }
  if (feed_.is_known() && source.simulation() == nullptr) return;
  feed_.follow(source.simulation());
  for (const setting_change& each : options_.settings) {
    const auto done = source.lidar().ask(change_to(each.value));
    if (!done) logger::info(in_tool_words(done.error().message()) + "\n");
  }
  if (const auto kind = kind_of_source(which_.source);
      kind == source_kind::device || kind == source_kind::simulated) {
    parameters_.fix("serial_number", std::string(source.lidar().information().serial_number()));
    parameters_.read_device(source.lidar());
  }
}

void lidar_node::on_points(std::span<const point> points) {
  if (!robot_ || points.empty()) return;
  feed_.follow(points, [this](const stamped_odometry& at) {
    merger_ == nullptr ? path_.add(at) : merger_->add(at);
    const std::int64_t at_ns = stamp_ns(at.time_ns);
    robot_->publish(at, at_ns);
    if (time_) time_->reach(at_ns);
  });
  const std::int64_t now_ns = stamp_ns(points.back().time_ns);
  if (time_) time_->reach(now_ns);
  robot_->publish_clock(now_ns);
}

void lidar_node::on_scan(const scan& whole) {
  if (whole.is_piece()) return;
  if (driven_ && !feed_.is_known()) driven_->take(path_, stamp_ns(0));
  shaper_.shape(whole, path_.until(whole.end_ns()));
  if (report_) report_->add(whole.size(), shaper_.outside());
  const scan_times when{whole.time_ns(), whole.duration_ns, stamp_ns(0)};
  const grid_options& grid = parameters_.filters().grid;
  if (merger_ != nullptr) return merger_->add(index_, shaper_, grid, when);
  if (messages_->wants_scan()) messages_->publish_scan(shaper_.for_grid(), grid, when);
  if (messages_->wants_points()) messages_->publish_points(shaper_.kept(), when);
}

void lidar_node::on_event(const lidar_event& event) {
  logger::info(fmt::format("{}: {}\n", station_->name(), name_of(event.what)));
}

void lidar_node::on_state(station_state state, std::string_view why) {
  // The failure of the only lidar is reported at the end of the program.
  if (state == station_state::ended && options_.sources.size() <= 1) why = {};
  logger::info(fmt::format("{}{}: {}{}{}\n", which_.name.empty() ? "lidar" : "lidar ", which_.name,
                           name_of(state), why.empty() ? "" : ". ", in_tool_words(why)));
}

}  // namespace g4_tool
