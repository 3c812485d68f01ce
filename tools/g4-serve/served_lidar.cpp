// SPDX-License-Identifier: MIT
#include "served_lidar.hpp"

#include <memory>
#include <utility>

#include "io/service_source.hpp"
#include "io/source_word.hpp"

namespace g4_tool {

served_lidar::served_lidar(const serve_options& options, const named_source& source,
                           std::size_t count)
    : name_(source.name),
      options_(options.common),
      playback_{.speed = options.speed, .loop = options.loops},
      recorder_(options.record_directory, options.record_limit,
                {.name = source.name, .count = count}) {
  options_.source = source.source;
  options_.mount = source.mount;
}

service_lidar served_lidar::for_service() {
  auto tap = for_each_connection([this](auto inner) { return bytes_.observe(std::move(inner)); });
  if (is_live() && recorder_.is_allowed()) {
    tap = [this, bytes = std::move(tap)](std::unique_ptr<connector> inner) {
      return bytes(recorder_.observe(std::move(inner)));
    };
  }
  service_lidar made = service_lidar_of(options_, {.playback = playback_, .wrap = std::move(tap)});
  made.name = name_;
  return made;
}

void served_lidar::add(const g4lidar::scan& found) {
  rates_.add(found, scan_rates::clock::now());
  recorder_.add(found);
}

std::vector<std::uint8_t> served_lidar::take_bytes(bool is_wanted) {
  std::vector<std::uint8_t> message = bytes_.take();
  bytes_.want(is_wanted);
  if (!is_wanted) message.clear();
  return message;
}

page_status served_lidar::status(const lidar_service& service, std::size_t index) {
  const reader_status now = service.status(index);
  page_status made{.lidar = name_,
                   .state = now.state,
                   .recognised = now.recognised,
                   .counts = service.counts(index),
                   .stages = service.stages(index),
                   .playback = now.playback,
                   .recording = recorder_.status()};
  made.why = why_of(options_, now.why, made.counts);
  rates_.put(made, scan_rates::clock::now());
  made.loss = loss_.add(made.counts);
  return made;
}

}  // namespace g4_tool
