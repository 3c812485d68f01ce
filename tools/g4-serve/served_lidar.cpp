// SPDX-License-Identifier: MIT
#include "served_lidar.hpp"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/settings.hpp"

namespace g4_tool {
namespace {

double seconds_of(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

nlohmann::ordered_json unknown_settings() {
  nlohmann::ordered_json all;
  for (const setting_info& each : all_settings()) all[std::string(each.name)] = nullptr;
  return all;
}

}  // namespace

served_lidar::served_lidar(const serve_options& options, const named_source& which,
                           std::size_t index, std::size_t count, client_registry& to,
                           lidar_listener& listener)
    : name_(which.name),
      index_(index),
      options_(options.common),
      playback_{.speed = options.speed, .loop = options.loops},
      registry_(to),
      listener_(listener),
      recorder_(options.record_directory, options.record_limit,
                {.name = which.name, .count = count}),
      settings_(unknown_settings()) {
  options_.source = which.source;
  options_.mount = which.mount;
}

lidar_options served_lidar::how_to_open() {
  auto tap = for_each_connection([this](auto inner) { return bytes_.observe(std::move(inner)); });
  if (is_live() && recorder_.is_allowed()) {
    tap = [this, bytes = std::move(tap)](std::unique_ptr<connector> from) {
      return bytes(recorder_.observe(std::move(from)));
    };
  }
  return {.playback = playback_, .wrap = std::move(tap)};
}

bool served_lidar::is_live() const {
  const source_kind kind = kind_of_source(options_.source);
  return kind == source_kind::device || kind == source_kind::simulated;
}

page_lidar served_lidar::known() const {
  const reader_status now = reader().status();
  const std::lock_guard lock(mutex_);
  return {.name = name_, .device = now.information, .model = model_, .settings = settings_};
}

void served_lidar::on_open(g4lidar::lidar& device) {
  listener_.on_lidar_open(*this, device);
  nlohmann::ordered_json settings = unknown_settings();
  if (is_live()) {
    recorder_.opened(device);
    for (const setting_info& each : all_settings()) {
      settings[std::string(each.name)] = json_of(read_setting(device, each));
    }
  }
  {
    const std::lock_guard lock(mutex_);
    settings_ = std::move(settings);
    model_ = device.recognition().model;
  }
  listener_.on_lidar_change(true);
}

void served_lidar::on_scan(const g4lidar::scan& scan) {
  rates_.add(scan, scan_rates::clock::now());
  bool is_other = false;
  {
    const std::lock_guard lock(mutex_);
    is_other = std::exchange(model_, scan.model) != scan.model;
  }
  if (is_other) listener_.on_lidar_change(true);
  listener_.on_lidar_scan(*this, scan);
  recorder_.add(scan);
}

void served_lidar::on_event(const lidar_event& event) {
  const std::string what(name_of(event.what));
  logger::info(fmt::format("{}: {}\n", reader().status().name, what));
  registry_.event(event_text(what, seconds_of(reader().wall_ns(event.time_ns)), name_));
}

void served_lidar::on_state(reader_state state, const std::optional<error>& why) {
  if (state == reader_state::opening && why) {
    logger::info(fmt::format("{}{} Trying again.\n", prefix(), source_->why()));
  }
}

std::vector<std::uint8_t> served_lidar::take_bytes(bool is_wanted) {
  std::vector<std::uint8_t> message = bytes_.take();
  bytes_.want(is_wanted);
  if (!is_wanted) message.clear();
  return message;
}

page_status served_lidar::status() {
  const reader_status now = reader().status();
  page_status made{.lidar = name_,
                   .state = now.state,
                   .why = source_->why(),
                   .recognised = now.recognised,
                   .counts = reader().counts(),
                   .stages = source_->stages(),
                   .playback = now.playback,
                   .recording = recorder_.status()};
  rates_.put(made, scan_rates::clock::now());
  made.loss = loss_.add(made.counts);
  return made;
}

void served_lidar::set(const std::string& word, answer_function done) {
  reader().ask(
      [this, word, then = std::move(done)](g4lidar::lidar* lidar) { execute(lidar, word, then); });
}

void served_lidar::execute(g4lidar::lidar* lidar, const std::string& word,
                           const answer_function& done) {
  if (lidar == nullptr) return done("the lidar is not connected");
  std::optional<setting_change> read;
  try {
    read = change_of(word, lidar->recognition().model);
  } catch (const bad_value& reason) {
    return done(reason.what());
  }
  const setting_change wanted = *read;
  const auto given = lidar->ask(change_to(wanted.value), while_scanning::stop_and_resume);
  if (!given) return done(in_tool_words(given.error().message()));
  {
    const std::lock_guard lock(mutex_);
    settings_[std::string(wanted.which->name)] = json_of(maybe_answer(*given));
  }
  listener_.on_lidar_change(false);
  done({});  // first, because a page may send the next setting at once
  listener_.on_lidar_settings();
}

void served_lidar::record(bool is_on, answer_function done) {
  if (recorder_.is_allowed() && !is_live()) return done("a recording cannot be recorded again");
  if (!recorder_.is_allowed()) return done(recorder_.set(true));
  reader().ask([this, is_on, then = std::move(done)](g4lidar::lidar* /*lidar*/) {
    then(recorder_.set(is_on));
  });
}

void served_lidar::discard_recording() {
  reader().ask([this](g4lidar::lidar* /*lidar*/) { recorder_.discard(); });
}

}  // namespace g4_tool
