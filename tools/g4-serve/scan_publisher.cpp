// SPDX-License-Identifier: MIT
#include "scan_publisher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/settings.hpp"
#include "g4lidar/diagnostics/diagnostic_message.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "io/shape_files.hpp"

namespace g4_tool {
namespace {

using namespace std::chrono_literals;

constexpr auto rate_window = 3s;
constexpr double ns_in_s = 1e9;
// Of a playback.
constexpr double least_speed = 0.01;
constexpr double largest_speed = 100.0;

double seconds_of(std::int64_t ns) { return static_cast<double>(ns) / ns_in_s; }

std::int64_t wall_now_ns() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

nlohmann::ordered_json unknown_settings() {
  nlohmann::ordered_json all;
  for (const setting_info& each : all_settings()) all[std::string(each.name)] = nullptr;
  return all;
}

}  // namespace

void scan_rates::add(const g4lidar::scan& scan, clock::time_point now) {
  const std::lock_guard lock(mutex_);
  times_.push_back(now);
  while (now - times_.front() > rate_window) times_.pop_front();
  sample_rate_hz_ = static_cast<double>(scan.measured_sample_rate_hz());
  frequency_hz_ = static_cast<double>(scan.measured_frequency_hz());
}

void scan_rates::put(page_status& into, clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  if (times_.size() < 2 || now - times_.back() > rate_window) return;
  const std::chrono::duration<double> took = times_.back() - times_.front();
  if (took.count() > 0) into.scan_rate_hz = static_cast<double>(times_.size() - 1) / took.count();
  into.sample_rate_hz = sample_rate_hz_;
  into.frequency_hz = frequency_hz_;
}

double loss_window::add(const lidar_counts& counts) {
  constexpr std::size_t ticks = 20;
  const sums now{counts.stream.points, counts.samples_lost};
  // The counts restart at 0 when the lidar is opened again.
  if (!sums_.empty() && now.points < sums_.back().points) sums_.clear();
  sums_.push_back(now);
  if (sums_.size() > ticks + 1) sums_.pop_front();
  const auto points = static_cast<double>(now.points - sums_.front().points);
  const auto lost = static_cast<double>(now.lost - sums_.front().lost);
  return lost > 0 ? lost / (points + lost) : 0.0;
}

scan_publisher::scan_publisher(const serve_options& options, client_registry& to)
    : options_(options),
      registry_(to),
      scans_(options.common, true),  // nobody is to deskew the points of a message again
      recorder_(options.record_directory, options.record_limit),
      settings_(unknown_settings()) {
  const g4lidar::mask mask = load_mask(options.common.mask);
  const shaping_options shape = shape_of(options.common, mask);
  if (shape.deskew == deskewing::none) unmoved_.set_options(shape);
  if (shape.deskew != deskewing::none) report_.emplace(shape.deskew, "in the source");
}

lidar_options scan_publisher::how_to_open() {
  auto tap = for_each_connection([this](auto inner) { return bytes_.observe(std::move(inner)); });
  if (is_live() && recorder_.is_allowed()) {
    tap = [this, bytes = std::move(tap)](std::unique_ptr<connector> from) {
      return bytes(recorder_.observe(std::move(from)));
    };
  }
  return {.playback = {.speed = options_.speed, .loop = options_.loops}, .wrap = std::move(tap)};
}

bool scan_publisher::is_live() const {
  const source_kind kind = kind_of_source(options_.common.source);
  return kind == source_kind::device || kind == source_kind::simulated;
}

void scan_publisher::on_open(g4lidar::lidar& device) {
  scans_.open(device, source_->simulation());
  if (is_live()) {
    recorder_.opened(device);
    for (const setting_info& each : all_settings()) {
      settings_[std::string(each.name)] = json_of(read_setting(device, each));
    }
  }
  send_hello(true);
}

void scan_publisher::send_hello(bool sends) {
  const reader_status now = reader().status();
  registry_.send_hello(
      hello_text({.source = options_.common.source.empty() ? now.name : options_.common.source,
                  .device = now.information,
                  .allows_set = options_.allows_set,
                  .allows_record = recorder_.is_allowed() && is_live(),
                  .settings = settings_,
                  .recording_s = now.playback ? std::optional(seconds_of(now.playback->length_ns))
                                              : std::nullopt}),
      sends);
}

void scan_publisher::on_scan(const g4lidar::scan& scan) {
  rates_.add(scan, scan_rates::clock::now());
  const client_registry::demand wanted = registry_.wanted();
  const bool wants_scan = wanted.wants(channel::scan);
  const bool wants_points = wanted.wants(channel::points);
  // A file that a client makes of them has no model, so it would be read as that of a G4.
  publish_bytes(wanted.wants(channel::from_device) && scan.model->word == g4_model.word);
  scans_.add(scan, [this](const stamped_odometry& at) { recorder_.add(at); });
  recorder_.add(scan);
  if (report_) report_->add(scan.size(), scans_.shaper().outside());
  if (!report_) unmoved_.shape(scan);
  scan_shaper& shaped = report_ ? scans_.shaper() : unmoved_;
  message_header header{.stamp_ns = reader().wall_ns(scan.time_ns()),
                        .frame_id = options_.frame_id,
                        .duration_ns = scan.duration_ns,
                        .model = scan.model};
  if (wanted.page) publish_page(scans_.shaper().kept());
  if (wants_scan) {
    std::vector<std::uint8_t> message;
    ranges_m_.resize(options_.bins.value_or(default_bins(*scan.model)));
    intensities_.resize(has_intensity(*scan.model) ? ranges_m_.size() : 0);
    header.intensities = intensities_;
    fill_grid(shaped.for_grid(), ranges_m_, options_.common.grid, intensities_);
    put_laser_scan(ranges_m_, header, message);
    registry_.publish(channel::scan, header.stamp_ns, std::move(message));
  }
  if (wants_points) {
    std::vector<std::uint8_t> message;
    put_point_cloud2(shaped.kept().points, header, message);
    registry_.publish(channel::points, header.stamp_ns, std::move(message));
  }
}

void scan_publisher::publish_page(const g4lidar::scan& scan) {
  std::vector<std::uint8_t> message;
  message.reserve(64 + 8 * scan.size());
  put_page_scan({.revolution = scan,
                 .stamp_s = seconds_of(reader().wall_ns(scan.time_ns())),
                 .place = scans_.place(),
                 .is_upside_down = scans_.is_upside_down()},
                message);
  registry_.page_scan(std::move(message));
}

/// Publishes one message per revolution.
void scan_publisher::publish_bytes(bool is_wanted) {
  if (std::vector<std::uint8_t> message = bytes_.take(); is_wanted && !message.empty()) {
    registry_.publish(channel::from_device, reader().wall_ns(bytes_.arrival_ns()),
                      std::move(message));
  }
  bytes_.want(is_wanted);
}

void scan_publisher::on_event(const lidar_event& event) {
  const std::string what(name_of(event.what));
  logger::info(fmt::format("{}: {}\n", reader().status().name, what));
  registry_.event(event_text(what, seconds_of(reader().wall_ns(event.time_ns))));
}

void scan_publisher::on_state(reader_state state, const std::optional<error>& why) {
  if (state == reader_state::opening && why) {
    logger::info(fmt::format("{} Trying again.\n", source_->why()));
  }
}

void scan_publisher::tick() {
  const reader_status now = reader().status();
  page_status status{.state = now.state,
                     .why = source_->why(),
                     .counts = reader().counts(),
                     .stages = source_->stages(),
                     .playback = now.playback,
                     .recording = recorder_.status()};
  rates_.put(status, scan_rates::clock::now());
  status.loss = loss_.add(status.counts);
  registry_.status(status_text(status));
  if (++ticks_ % 2 == 0 && registry_.wanted().wants(channel::diagnostics))
    publish_diagnostics(status);
}

void scan_publisher::publish_diagnostics(const page_status& status) {
  const auto known = reader().status().information;
  const std::string serial(known ? known->serial_number() : "");
  const std::int64_t now_ns = wall_now_ns();
  std::vector<std::uint8_t> message;
  auto statuses = statuses_of(status.stages, status.counts, serial);
  if (report_) statuses.emplace_back(report_->status()).hardware_id = serial;
  put_diagnostic_array(statuses, now_ns, message);
  registry_.publish(channel::diagnostics, now_ns, std::move(message));
}

void scan_publisher::set(const set_request& wanted, std::function<void(const std::string&)> done) {
  std::string word = wanted.name + '=' + wanted.value;
  try {
    static_cast<void>(change_of(word));
  } catch (const bad_value& reason) {
    return done(reason.what());
  }
  reader().ask([this, checked = std::move(word), then = std::move(done)](g4lidar::lidar* lidar) {
    execute(lidar, checked, then);
  });
}

void scan_publisher::execute(g4lidar::lidar* lidar, const std::string& word,
                             const std::function<void(const std::string&)>& done) {
  if (lidar == nullptr) return done("the lidar is not connected");
  const setting_change wanted = change_of(word);
  const auto given = lidar->ask(change_to(wanted.value), while_scanning::stop_and_resume);
  if (!given) return done(in_tool_words(given.error().message()));
  settings_[std::string(wanted.which->name)] = json_of(maybe_answer(*given));
  send_hello(false);
  done({});  // first, because a page may send the next setting at once
  registry_.settings(settings_text(settings_));
}

void scan_publisher::record(const record_request& wanted,
                            std::function<void(const std::string&)> done) {
  if (recorder_.is_allowed() && !is_live()) return done("a recording cannot be recorded again");
  if (!recorder_.is_allowed()) return done(recorder_.set(true));
  reader().ask([this, wanted, then = std::move(done)](g4lidar::lidar* /*lidar*/) {
    then(recorder_.set(wanted.is_on));
  });
}

void scan_publisher::play(const play_request& wanted) {
  if (wanted.paused) reader().pause(*wanted.paused);
  if (wanted.speed) {
    const double speed = std::clamp(*wanted.speed, least_speed, largest_speed);
    static_cast<void>(reader().set_speed(*wanted.speed > 0 ? speed : 0));
  }
  if (wanted.seek_s) {
    constexpr double longest_s = 1e9;
    reader().seek(static_cast<std::int64_t>(std::clamp(*wanted.seek_s, 0.0, longest_s) * ns_in_s));
  }
}

}  // namespace g4_tool
