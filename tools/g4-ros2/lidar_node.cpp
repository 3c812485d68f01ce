// SPDX-License-Identifier: MIT
#include "lidar_node.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/interrupt.hpp"
#include "io/shape_files.hpp"
#include "merger.hpp"

namespace g4_tool {
namespace {

common_options options_of(const ros2_options& options, const named_source& which) {
  common_options made = options.common;
  made.source = which.source;
  made.mount = which.mount;
  return made;
}

/// How the scans of a lidar are shaped, for its own messages or for merging.
shaping_options shaping_of(const common_options& how, const mask& loaded, bool merges) {
  shaping_options made = shape_of(how, loaded);
  made.for_merging = merges;
  made.restamps = true;  // nobody is to deskew the points of a message again
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
      mask_(mask_in(options.common.mask)),
      shaper_(shaping_of(options_of(options, which), mask_, into != nullptr)) {
  const std::string frame_id = frame_of(options, which.name);
  if (merger_ == nullptr) {
    messages_ = std::make_unique<scan_messages>(on, options, name_space_, frame_id);
  }
  if (which.mount && merger_ == nullptr) {
    place_ = publisher_of(on, options.name_space, options.topics.tf_static,
                          {.type = &dds::tf_message, .depth = 1, .is_for_late = true});
    if (place_) place_->publish(place_message(options, frame_id, *which.mount));
  }
  const bool is_by_path = options.common.deskew == deskewing::by_path && merger_ == nullptr;
  is_played_ = kind_of_source(which.source) == source_kind::recording;
  if (is_played_) feed_.set(odometry_of_recording(path_of_source(which.source)));
  // Merged lidars have one robot, which belongs to the first lidar.
  if (merger_ == nullptr || index == 0) {
    const bool is_known = feed_.is_known() || has_simulated_robot(which.source);
    robot_.emplace(on, options, merger_ == nullptr ? name_space_ : options.name_space,
                   robot_knowledge{is_known, index == 0 && is_played_});
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
  const bool wants_points =
      is_played_ || (robot_ && kind_of_source(which.source) == source_kind::simulated);
  device_ = std::make_unique<source_reader>(
      options_of(options, which), options.source, *this,
      reader_options{.wants_points = wants_points, .starts_rested = options.is_standby});
}

lidar_node::~lidar_node() = default;

bool lidar_node::is_wanted() const {
  return merger_ == nullptr ? messages_->is_wanted() : merger_->is_wanted();
}

void lidar_node::update() {
  const bool rests = standby_.rests(!options_.is_standby || is_wanted(), clock::now());
  device_->reader().rest(rests || !is_allowed_);
  const std::chrono::nanoseconds wall = std::chrono::system_clock::now().time_since_epoch();
  diagnostics_.update(*device_, messages_ ? *messages_ : merger_->messages(),
                      is_played_ ? now_ns_.load() : wall.count());
}

void lidar_node::on_open(g4lidar::lidar& device) {
  if (is_played_) {
    feed_.follow(*device.player());
    now_ns_ = stamp_ns(device.player()->begin_ns());
  } else {
    feed_.follow(device_->simulation());
  }
  for (const setting_change& each : options_.settings) {
    const auto done = device.ask(change_to(each.value));
    if (!done) logger::info(in_tool_words(done.error().message()) + "\n");
  }
}

void lidar_node::on_points(std::span<const point> points) {
  if (is_played_) now_ns_ = std::max(now_ns_.load(), stamp_ns(points.back().time_ns));
  if (!robot_) return;
  feed_.follow(points, [this](const stamped_odometry& at) {
    merger_ == nullptr ? path_.add(at) : merger_->add(at);
    robot_->publish(at, stamp_ns(at.time_ns));
  });
  robot_->publish_clock(stamp_ns(points.back().time_ns));
}

void lidar_node::on_scan(const scan& whole) {
  if (whole.is_piece()) return;
  if (driven_ && !feed_.is_known()) driven_->take(path_, stamp_ns(0));
  shaper_.shape(whole, path_.until(whole.end_ns()));
  if (report_) report_->add(whole.size(), shaper_.outside());
  const scan_times when{whole.time_ns(), whole.duration_ns, stamp_ns(0)};
  grid_options grid = options_.common.grid;
  grid.longest_mm = options_.common.filter.greatest_range_mm;
  if (merger_ != nullptr) return merger_->add(index_, shaper_, grid, when);
  if (messages_->wants_scan()) messages_->publish_scan(shaper_.for_grid(), grid, when);
  if (messages_->wants_points()) messages_->publish_points(shaper_.kept(), when);
}

void lidar_node::on_event(const lidar_event& event) {
  logger::info(fmt::format("{}: {}\n", device_->reader().status().name, name_of(event.what)));
}

void lidar_node::on_state(reader_state state, const std::optional<error>& /*why*/) {
  std::string why = device_->why();
  // The failure of the only lidar is reported at the end of the program.
  if (state == reader_state::ended && options_.sources.size() <= 1) why.clear();
  logger::info(fmt::format("{}{}: {}{}{}\n", which_.name.empty() ? "lidar" : "lidar ", which_.name,
                           name_of(state), why.empty() ? "" : ". ", why));
}

}  // namespace g4_tool
