// SPDX-License-Identifier: MIT
#include "service_source.hpp"

#include <cstdint>
#include <exception>
#include <utility>

#include "cli/logger.hpp"
#include "cli/option_rows.hpp"
#include "g4lidar/transport/source.hpp"
#include "input.hpp"
#include "output.hpp"
#include "shape_files.hpp"
#include "source_word.hpp"

namespace g4_tool {

service_lidar service_lidar_of(const common_options& options, const lidar_options& wanted) {
  return {.options = options_for(options, wanted), .mount = options.mount};
}

service_options service_options_of(const common_options& options) {
  service_options made{.filters = options, .mask = mask_in(options.mask), .deskew = options.deskew};
  made.filters.filter.in = options.frame;
  return made;
}

std::unique_ptr<lidar_service> make_service(std::vector<service_lidar> lidars,
                                            service_options options,
                                            const std::vector<service_output>& outputs) {
  auto made = lidar_service::make(std::move(lidars), std::move(options), outputs);
  if (!made && made.error() == problem::bad_option)
    throw bad_value(std::string(made.error().subject()));
  return value_of(std::move(made));
}

std::optional<failure> failure_of(const common_options& options, const std::optional<error>& why,
                                  const lidar_counts& counts) {
  if (!why || *why == problem::cancelled) return std::nullopt;
  if (*why != problem::end_of_input || !names_file(options.source))
    return failure_of(options, *why);
  if (counts.stream.packets > 0) return std::nullopt;
  if (kind_of_source(options.source) == source_kind::recording)
    return no_packet_in(options.source, false);
  std::vector<std::uint8_t> beginning;
  try {
    beginning = beginning_of(path_of_source(options.source));
  } catch (const std::exception&) {  // it was removed, or a signal came: its counts are known
  }
  return without_packets(counts.stream, counts.bytes, beginning, in_quotes(options.source));
}

std::string why_of(const common_options& options, const std::optional<error>& why,
                   const lidar_counts& counts) {
  const auto failed = failure_of(options, why, counts);
  return failed ? failed->what() : "";
}

std::optional<failure> final_failure_of(const common_options& options, const lidar_service& service,
                                        std::size_t lidar) {
  const reader_status now = service.status(lidar);
  if (now.state != reader_state::ended) return std::nullopt;
  return failure_of(options, now.why, service.counts(lidar));
}

void report_motion(bool is_known, const std::string& why) {
  logger::info((is_known ? "points are deskewed: the motion is known" : why) + '\n');
}

}  // namespace g4_tool
