// SPDX-License-Identifier: MIT
// The verb health: the health status that a device reports.
#include <nlohmann/json.hpp>

#include "io/command_source.hpp"
#include "io/output.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

exit_code health(const common_options& options) {
  output out(options.output);
  command_source source(options, task::asking);
  const auto given = value_of(source.lidar().ask(requests::health()));
  nlohmann::ordered_json all{{"source", source.lidar().name()},
                             {"status", g4lidar::name_of(given.status)},
                             {"error_code", given.error_code}};
  if (!options.json) all.erase("source");
  write_object(out, all, 12, options.json);
  out.commit();
  return given.status == health_status::error ? exit_code::unhealthy : exit_code::ok;
}

constexpr const char* health_details =
    R"(Two lines: status (ok, warning, error) and error_code. The meaning of the bits of the code is
not documented. The exit code is 8 if the status is error. A device that is scanning is stopped
first; that is reported.)";

}  // namespace

verb make_health_verb() {
  return device_verb({.name = "health",
                      .summary = "Print the health status",
                      .details = health_details,
                      .examples = {{"g4-dump health", "Health of the only G4"},
                                   {"g4-dump health 'sim:?fault=health=warning'",
                                    "A simulated G4 with a warning"}}},
                     health, true);
}

}  // namespace g4_tool
