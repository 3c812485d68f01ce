// SPDX-License-Identifier: MIT
// The verb restart.
#include <fmt/format.h>

#include <chrono>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/command_source.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

exit_code restart(const common_options& options) {
  command_source source(options, task::asking);
  const auto begin = std::chrono::steady_clock::now();
  value_of(source.lidar().ask(requests::restart()));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  logger::info(fmt::format("{}: restarted; it answered after {:.1f} s. Its settings may be lost.\n",
                           source.lidar().name(), took.count()));
  return exit_code::ok;
}

}  // namespace

verb make_restart_verb() {
  return device_verb(
      {.name = "restart",
       .summary = "Restart the device and wait until it answers",
       .details = "It does not scan after the restart, and its settings may be lost.",
       .examples = {{"g4-dump restart", "Restart the only G4"}}},
      restart);
}

}  // namespace g4_tool
