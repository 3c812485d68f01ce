// SPDX-License-Identifier: MIT
#include "scan_publisher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/setting_words.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "io/service_source.hpp"

namespace g4_tool {
namespace {

constexpr double ns_in_s = 1e9;
// Of a playback.
constexpr double least_speed = 0.01;
constexpr double largest_speed = 100.0;

double seconds_of(std::int64_t ns) { return static_cast<double>(ns) / ns_in_s; }

/// "front: " of one of several lidars.
std::string prefix_of(const std::string& name) { return name.empty() ? "" : name + ": "; }

/// Collects the answers of several lidars about a recording, and passes their errors on when all have answered. Either
/// all of them are recorded or none: if one cannot be, what was begun is discarded.
class common_answer {
 public:
  common_answer(std::size_t count, std::function<void(const std::string&)> done)
      : left_(count), done_(std::move(done)) {}

  /// `discard` is called if another lidar cannot be recorded; null: nothing was begun.
  void add(const std::string& name, const std::string& error, std::function<void()> discard) {
    {
      const std::lock_guard lock(mutex_);
      if (!error.empty()) {
        errors_ += (errors_.empty() ? "" : "; ") + prefix_of(name) + error;
      } else if (discard) {
        begun_.push_back(std::move(discard));
      }
      if (--left_ > 0) return;
    }
    if (!errors_.empty()) {
      for (const auto& each : begun_) each();
    }
    done_(errors_);
  }

 private:
  std::mutex mutex_;
  std::size_t left_;
  std::string errors_;
  std::vector<std::function<void()>> begun_;
  std::function<void(const std::string&)> done_;
};

}  // namespace

scan_publisher::scan_publisher(const serve_options& options,
                               const std::vector<named_source>& lidars, client_registry& clients,
                               service_sink* other)
    : options_(options),
      frame_id_(frame_id_of(options)),
      registry_(clients),
      models_(lidars.size(), nullptr) {
  std::vector<service_lidar> served;
  for (const named_source& each : lidars) {
    served_lidar& made = lidars_.emplace_back(options, each, lidars.size());
    served.push_back(made.for_service());
  }
  service_options all = service_options_of(options.common);
  all.merges = options.merges;
  all.follows_motion = true;
  all.restamps = true;  // nobody is to deskew the points of a message again
  all.reads_settings = true;
  std::vector<service_output> outputs{{this, delivery::in_reader}};
  if (other != nullptr) outputs.push_back({other, delivery::in_reader});
  service_ = make_service(std::move(served), std::move(all), outputs);
}

void scan_publisher::start() { value_of(service_->start()); }

std::optional<failure> scan_publisher::failure_of_all() const {
  return g4_tool::failure_of_all(*service_, [this](std::size_t i) { return lidars_[i].options(); });
}

service_demand scan_publisher::wanted() const {
  const client_registry::wanted_messages now = registry_.wanted();
  return {.for_grid = now.wants(channel::scan),
          .kept = now.page || now.wants(channel::points),
          .runs = true};
}

void scan_publisher::on_open(std::size_t lidar, g4lidar::lidar& device) {
  logger::verbose(fmt::format("opened {}\n", device.name()));
  models_[lidar] = nullptr;
  if (lidars_[lidar].is_live()) lidars_[lidar].recorder().opened(device);
}

void scan_publisher::on_measured(std::size_t lidar, const scan& found) {
  served_lidar& here = lidars_[lidar];
  here.add(found);
  if (options_.merges) return;
  // A file that a client makes of them has no model, so it would be read as that of a G4.
  const bool is_wanted = registry_.wanted().wants(channel::from_device) && *found.model == g4_model;
  if (auto bytes = here.take_bytes(is_wanted); !bytes.empty()) {
    registry_.publish(channel::from_device, service_->stamp_ns(lidar, here.bytes_ns()),
                      std::move(bytes));
  }
}

void scan_publisher::on_scan(const service_scan& made) {
  const client_registry::wanted_messages now = registry_.wanted();
  const std::int64_t stamp_ns = made.stamp_ns(made.first_ns);
  message_header header{.stamp_ns = stamp_ns,
                        .frame_id = frame_id_,
                        .duration_ns = made.duration_ns,
                        .model = made.kept.model};
  std::vector<std::uint8_t> message;
  if (now.page && made.made.kept) {
    message.reserve(128 + 10 * made.kept.size());
    put_page_scan({.revolution = made.kept,
                   .stamp_s = seconds_of(stamp_ns),
                   .place = made.place,
                   .is_upside_down = made.is_upside_down,
                   .points_of_each = made.kept_of_each},
                  message);
    registry_.page_scan(std::exchange(message, {}));
  }
  if (now.wants(channel::scan) && made.made.for_grid) {
    fill_laser_scan(made.for_grid, header, options_.bins.value_or(default_bins(*header.model)),
                    made.grid, ranges_m_, intensities_);
    put_laser_scan(ranges_m_, header, message);
    registry_.publish(channel::scan, stamp_ns, std::exchange(message, {}));
  }
  if (now.wants(channel::points) && made.made.kept) {
    if (!made.kept.empty()) header.stamp_ns = made.stamp_ns(cloud_time_ns(made.kept.points));
    put_point_cloud2(made.kept.points,
                     {.stamp_ns = header.stamp_ns,
                      .frame_id = frame_id_,
                      .duration_ns = made.duration_ns,
                      .model = made.kept.model},
                     message);
    registry_.publish(channel::points, stamp_ns, std::move(message));
  }
}

void scan_publisher::on_odometry(const stamped_odometry& now, std::int64_t /*stamp_ns*/) {
  lidars_.front().recorder().add(now);
}

void scan_publisher::on_motion(bool is_known, const std::string& why) {
  report_motion(is_known, why);
}

void scan_publisher::on_event(std::size_t lidar, const lidar_event& what, std::int64_t stamp_ns) {
  const std::string name(name_of(what.what));
  logger::info(fmt::format("{}: {}\n", service_->status(lidar).name, name));
  registry_.event(event_text(name, seconds_of(stamp_ns), lidars_[lidar].name()));
}

void scan_publisher::on_state(std::size_t lidar, reader_state state,
                              const std::optional<error>& why) {
  if (!why) return;
  const served_lidar& here = lidars_[lidar];
  const std::string text = why_of(here.options(), why, service_->counts(lidar));
  if (text.empty()) return;
  const std::string line = prefix_of(here.name()) + text;
  if (state == reader_state::opening)
    logger::info(line + " Trying again.\n");
  else if (state == reader_state::ended && lidars_.size() > 1)  // the others go on
    logger::info(line + '\n');
  else
    logger::verbose(line + '\n');
}

void scan_publisher::on_values(std::size_t lidar, const std::string& /*refused*/) {
  const g4lidar::model* const now = service_->model(lidar);
  const bool is_other = std::exchange(models_[lidar], now) != now;
  send_hello(is_other);
  if (!is_other) registry_.settings(settings_text(known()));
}

std::vector<page_lidar> scan_publisher::known() const {
  std::vector<page_lidar> all;
  for (std::size_t i = 0; i < lidars_.size(); ++i) {
    page_lidar& made = all.emplace_back();
    made.name = lidars_[i].name();
    made.device = service_->status(i).information;
    made.model = service_->model(i);
    for (const parameter& each : all_parameters()) {
      if (each.setting == nullptr) continue;
      made.settings[std::string(each.name)] = json_of(service_->value(i, each));
    }
  }
  return all;
}

void scan_publisher::send_hello(bool sends) {
  const reader_status now = service_->status(0);
  const served_lidar& first = lidars_.front();
  std::string source = first.options().source.empty() ? now.name : first.options().source;
  if (options_.merges) {
    source.clear();
    for (const served_lidar& each : lidars_)
      source += (source.empty() ? "" : ", ") + each.name() + '=' + each.options().source;
  }
  registry_.send_hello(
      hello_text({.source = source,
                  .lidars = known(),
                  .allows_set = options_.allows_set,
                  .allows_record = !options_.record_directory.empty() && first.is_live(),
                  .recording_s = now.playback ? std::optional(seconds_of(now.playback->length_ns))
                                              : std::nullopt}),
      sends);
}

page_status scan_publisher::tick() {
  std::vector<page_status> all;
  all.reserve(lidars_.size());
  for (std::size_t i = 0; i < lidars_.size(); ++i) all.push_back(lidars_[i].status(*service_, i));
  page_status status = options_.merges ? merged_status(std::move(all)) : std::move(all.front());
  registry_.status(status_text(status));
  if (++ticks_ % 2 == 0 && registry_.wanted().wants(channel::diagnostics)) publish_diagnostics();
  return status;
}

void scan_publisher::publish_diagnostics() {
  const std::int64_t now_ns =
      std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  std::vector<std::uint8_t> message;
  const auto why = [this](std::size_t i) {
    return why_of(lidars_[i].options(), service_->status(i).why, service_->counts(i));
  };
  put_diagnostic_array(service_->diagnosis(why), now_ns, message);
  registry_.publish(channel::diagnostics, now_ns, std::move(message));
}

void scan_publisher::set(const set_request& wanted, std::function<void(const std::string&)> done) {
  const auto found = std::ranges::find(lidars_, wanted.lidar, &served_lidar::name);
  if (found == lidars_.end()) return done("there is no lidar " + in_quotes(wanted.lidar));
  const auto index = static_cast<std::size_t>(found - lidars_.begin());
  named_value value;
  try {
    const auto read = change_of(wanted.name + '=' + wanted.value, service_->model(index));
    value = {std::string(read.which->name), g4lidar::value_of(read.value)};
  } catch (const bad_value& reason) {
    return done(reason.what());
  }
  service_->change(index, {value}, [then = std::move(done)](const std::string& why_not) {
    then(in_tool_words(why_not));
  });
}

void scan_publisher::record_one(std::size_t lidar, bool is_on,
                                std::function<void(const std::string&)> done) {
  served_lidar& here = lidars_[lidar];
  if (here.recorder().is_allowed() && !here.is_live())
    return done("a recording cannot be recorded again");
  if (!here.recorder().is_allowed()) return done(here.recorder().set(true));
  service_->ask(lidar, [&here, is_on, then = std::move(done)](g4lidar::lidar* /*lidar*/) {
    then(here.recorder().set(is_on));
  });
}

void scan_publisher::record(const record_request& wanted,
                            std::function<void(const std::string&)> done) {
  if (options_.record_directory.empty()) return record_one(0, wanted.is_on, std::move(done));
  const auto answer = std::make_shared<common_answer>(lidars_.size(), std::move(done));
  for (std::size_t i = 0; i < lidars_.size(); ++i) {
    const auto discard = [this, i] {
      service_->ask(i,
                    [&here = lidars_[i]](g4lidar::lidar* /*lidar*/) { here.recorder().discard(); });
    };
    record_one(i, wanted.is_on,
               [this, i, answer, discard, begins = wanted.is_on](const std::string& error) {
                 answer->add(lidars_[i].name(), error, begins ? discard : std::function<void()>());
               });
  }
}

void scan_publisher::play(const play_request& wanted) {
  if (wanted.paused) service_->pause(*wanted.paused);
  if (wanted.speed) {
    const double speed = std::clamp(*wanted.speed, least_speed, largest_speed);
    static_cast<void>(service_->set_speed(*wanted.speed > 0 ? speed : 0));
  }
  if (wanted.seek_s) {
    constexpr double longest_s = 1e9;
    service_->seek(static_cast<std::int64_t>(std::clamp(*wanted.seek_s, 0.0, longest_s) * ns_in_s));
  }
}

}  // namespace g4_tool
