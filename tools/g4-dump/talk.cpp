// SPDX-License-Identifier: MIT
#include "talk.hpp"

#include <fmt/format.h>

#include <utility>

#include "exit_code.hpp"
#include "listening_connector.hpp"
#include "manners.hpp"
#include "output.hpp"

namespace g4_dump {

void refuse_files(const common_options& options, g4lidar::task doing) {
  const source_kind kind = kind_of(options.source);
  if (kind == source_kind::device || kind == source_kind::simulated) return;
  throw failure(g4lidar::error(doing, g4lidar::problem::read_only, options.source));
}

namespace {

line_wrapper listening(bool& heard) {
  return [&heard](std::unique_ptr<g4lidar::connector> lines) {
    return std::make_unique<listening_connector>(std::move(lines), heard);
  };
}

}  // namespace

talking_source::talking_source(const common_options& options, g4lidar::task doing)
    : source_((refuse_files(options, doing), options), {}, listening(was_scanning_)) {
  while (const auto event = lidar().next_event()) {
    was_scanning_ = was_scanning_ || event->what == g4lidar::lidar_event::kind::found_scanning;
  }
  if (was_scanning_) tell(fmt::format("{}: it was scanning; stopped\n", lidar().name()));
}

option_row json_row(std::shared_ptr<bool> flag) {
  return {.names = "--json",
          .value = "",
          .help = "JSON, an object a line",
          .take = [set = std::move(flag)](const std::string&) { *set = true; }};
}

void write_line(output& out, const nlohmann::ordered_json& value) {
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  out.write(value.dump(-1, ' ', false, replace) + "\n");
}

std::vector<int> talk_exits() { return {0, 2, 3, 4, 5, 6, 7, 8, 9, 10, 130}; }

}  // namespace g4_dump
