// SPDX-License-Identifier: MIT
// The verb stop.
#include <fmt/format.h>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/command_source.hpp"
#include "verbs/verbs.hpp"

namespace g4_tool {
namespace {

exit_code stop(const common_options& options) {
  command_source source(options, task::stopping);  // which has stopped it
  if (!source.was_scanning()) {
    logger::info(fmt::format("{}: stopped; it was not scanning\n", source.lidar().name()));
  }
  return exit_code::ok;
}

}  // namespace

verb make_stop_verb() {
  return device_verb({.name = "stop",
                      .summary = "Stop scanning",
                      .details = "The command ends when the device is silent. It is no error if "
                                 "the device was not scanning.",
                      .examples = {{"g4-dump stop", "Stop the only G4"}}},
                     stop);
}

}  // namespace g4_tool
