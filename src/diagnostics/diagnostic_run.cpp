// SPDX-License-Identifier: MIT
#include "g4lidar/diagnostics/diagnostic_run.hpp"

#include <string>
#include <utility>

#include "g4lidar/transport/serial_port.hpp"
#include "live_run.hpp"
#include "stages.hpp"

namespace g4lidar {

std::vector<stage_report> diagnose(std::string_view source, const diagnostic_options& options) {
  constexpr std::string_view file_prefix = "file:";
  diagnostic_options with_rates = options;
  stage_log log(with_rates);
  if (source.starts_with(file_prefix)) {
    examine_file(std::string(source.substr(file_prefix.size())), log);
    return std::move(log.stages());
  }
  auto opened = open_port(std::string(source), log);
  if (!opened) return std::move(log.stages());
  const std::string path(opened->name());
  if (!options.reopen && has_baud_rates(path)) {
    with_rates.reopen = [path](std::uint32_t rate) -> std::unique_ptr<transport> {
      auto again = serial_port::open(path, {.baud = rate});
      return again ? std::move(*again) : nullptr;
    };
  }
  live_run(std::move(opened), log).run();
  return std::move(log.stages());
}

std::vector<stage_report> diagnose(std::unique_ptr<transport> opened,
                                   const diagnostic_options& options) {
  stage_log log(options);
  live_run(std::move(opened), log).run();
  return std::move(log.stages());
}

std::vector<stage_report> diagnose(connector& from, const diagnostic_options& options) {
  auto opened = from.connect();
  if (opened) return diagnose(std::move(*opened), options);
  stage_log log(options);
  report_unopened(log, {}, opened.error());
  return std::move(log.stages());
}

}  // namespace g4lidar
