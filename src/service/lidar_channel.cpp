// SPDX-License-Identifier: MIT
#include "service/lidar_channel.hpp"

#include <algorithm>
#include <utility>

#include "g4lidar/transport/source.hpp"
#include "service/service_core.hpp"

namespace g4lidar {
lidar_channel::lidar_channel(service_lidar lidar, std::size_t index, service_core& core)
    : about_(std::move(lidar)),
      index_(index),
      core_(core),
      is_file_(names_file(about_.options.device)),
      reader_(observed_options(), {.wants_points = core.options().gives_points}, this) {
  for (const named_value& each : about_.settings) want(each);
  // Merged lidars are on one robot: that of the first one.
  if (index_ > 0) return;
  const std::string& source = about_.options.device;
  const service_options& options = core.options();
  const bool is_needed = options.gives_points || options.deskew == deskewing::by_path ||
                         (options.follows_motion && about_.mount);
  // What cannot be read is an error when it is opened.
  if (is_needed && kind_of_source(source) == source_kind::recording)
    static_cast<void>(feed_.load_recording(path_of_source(source), about_.options.is_cancelled));
  has_odometry_ = feed_.is_known() || has_simulated_robot(source);
}

lidar_options lidar_channel::observed_options() {
  lidar_options made = about_.options;
  made.wrap = [this](std::unique_ptr<connector> from) {
    simulation_ = simulation_of(*from);
    result<std::unique_ptr<connector>> inner =
        about_.options.wrap ? about_.options.wrap(std::move(from))
                            : result<std::unique_ptr<connector>>(std::move(from));
    if (inner) inner = diagnosis_.observe(std::move(*inner));
    return inner;
  };
  return made;
}

bool lidar_channel::is_failure(const error& why) const noexcept {
  return why != problem::cancelled && !(is_file_ && why == problem::end_of_input);
}

std::optional<std::int64_t> lidar_channel::ahead_ns() const {
  const std::int64_t wall_ahead_ns = reader_.wall_ns(0);
  const auto& clock = core_.options().stamp_clock;
  return clock && !is_file_ ? clock(wall_ahead_ns) : wall_ahead_ns;
}

void lidar_channel::show_model(const g4lidar::model& now) {
  model_ = &now;
  settings_.fix("model", std::string(now.word));
}

void lidar_channel::on_open(lidar& device) {
  if (index_ == 0) {
    if (player* const played = device.player())
      feed_.follow(*played);
    else
      feed_.follow(simulation_);
  }
  known_motion motion{.has_odometry = feed_.is_known(), .simulated = {}};
  if (simulation_ != nullptr) motion.simulated = mounting_on_robot(*simulation_);
  core_.opened(index_, motion);
  show_model(*device.recognition().model);
  const bool is_named = device.information().is_known();
  settings_.fix("serial_number",
                is_named ? parameter_value(std::string(device.information().serial_number()))
                         : parameter_value());
  // Another device may be at the port, or this one has lost its settings.
  for (const parameter& each : all_parameters()) {
    if (each.kind == parameter_kind::device) settings_.fix(each.name, {});
  }
  if (core_.options().reads_settings && !is_file_) settings_.read_device(device);
  std::string refused;
  for (const named_value& each : wanted_) {
    if (settings_.value(*find_parameter(each.first)) == each.second) continue;
    const std::string wrong = settings_.change(&device, std::span(&each, 1));
    if (!wrong.empty()) refused += (refused.empty() ? "" : "; ") + wrong;
  }
  // They may ask the device, which takes its time: other lidars do not wait for it.
  core_.sinks().each([&](service_sink& to) { to.on_open(index_, device); });
  core_.sinks().call([&](service_sink& to) { to.on_values(index_, refused); });
}

std::string lidar_channel::set(lidar* device, const std::vector<named_value>& wanted,
                               const std::function<std::string()>& then) {
  std::vector<named_value> before;
  for (const auto& [name, value] : wanted) {
    const parameter* const row = find_parameter(name);
    parameter_value now = row == nullptr ? parameter_value() : settings_.value(*row);
    if (now != parameter_value()) before.emplace_back(name, std::move(now));
  }
  std::string wrong = settings_.change(device, wanted);
  if (!wrong.empty()) return wrong;
  wrong = then();
  if (!wrong.empty()) {
    static_cast<void>(settings_.change(device, before));
    return wrong;
  }
  for (const named_value& each : wanted) want(each);
  return {};
}

void lidar_channel::want(const named_value& setting) {
  std::erase_if(wanted_, [&](const named_value& each) { return each.first == setting.first; });
  wanted_.push_back(setting);
}

void lidar_channel::follow_motion(std::span<const point> points) {
  feed_.follow(points, [this](const stamped_odometry& now) {
    const auto ahead = ahead_ns();
    core_.add(now, ahead ? service_scan{.ahead_ns = ahead}.stamp_ns(now.time_ns) : 0,
              feed_.begun());
  });
}

void lidar_channel::on_points(std::span<const point> found) {
  follow_motion(found);
  const service_scan clock{.ahead_ns = ahead_ns()};
  core_.sinks().call(
      [&](service_sink& to) { to.on_time(index_, clock.stamp_ns(found.back().time_ns)); });
}

void lidar_channel::on_scan(const scan& found) {
  if (found.model != model_.load()) {
    show_model(*found.model);
    core_.sinks().call([&](service_sink& to) { to.on_values(index_, {}); });
  }
  core_.sinks().call([&](service_sink& to) { to.on_measured(index_, found); });
  if (!core_.options().gives_points) follow_motion(found.points);
  core_.add(index_, found, ahead_ns());
}

void lidar_channel::on_event(const lidar_event& what) {
  diagnosis_.add(what);
  const service_scan clock{.ahead_ns = ahead_ns()};
  core_.sinks().call(
      [&](service_sink& to) { to.on_event(index_, what, clock.stamp_ns(what.time_ns)); });
}

void lidar_channel::on_state(reader_state state, const std::optional<error>& why) {
  if (why && is_failure(*why) && state != reader_state::lost && why->doing() == task::reading)
    diagnosis_.add(*why);
  core_.sinks().call([&](service_sink& to) { to.on_state(index_, state, why); });
}

}  // namespace g4lidar
