// SPDX-License-Identifier: MIT
// g4-dump: the console tool.
#include "verbs/dump_verbs.hpp"

namespace {

constexpr const char* description =
    R"(g4-dump is the console tool for the YDLIDAR G4 and its family, 360-degree lidars on a serial port.
Without a command it prints points, and without a source it takes the only lidar that is connected.
On a terminal, without any word, it lists the attached lidars and the commands, and sends nothing.

Data goes to standard output, messages go to standard error. Only the command acceptance asks
questions, and only acceptance and set change settings of the device. Control characters in what a device or a
file sent are escaped.)";

}  // namespace

namespace g4_tool {

std::vector<verb> all_verbs() {
  return {
      make_list_verb(),    make_watch_verb(),   make_info_verb(),    make_health_verb(),
      make_stats_verb(),   make_doctor_verb(),  make_dump_verb(),    make_scan_verb(),
      make_packets_verb(), make_decode_verb(),  make_sim_verb(),     make_set_verb(),
      make_start_verb(),   make_stop_verb(),    make_restart_verb(), make_record_verb(),
      make_replay_verb(),  make_convert_verb(), make_serve_verb(),   make_acceptance_verb(),
#if G4LIDAR_VIEW
      make_view_verb(),
#endif
  };
}

}  // namespace g4_tool

int main(int argc, char** argv) {
  const g4_tool::program g4_dump{.name = "g4-dump",
                                 .title = "The console tool for the YDLIDAR G4 and its family",
                                 .description = description,
                                 .verbs = g4_tool::all_verbs,
                                 .default_verb = "dump",
                                 .overview = g4_tool::print_overview};
  return g4_tool::run_program(g4_dump, argc, argv);
}
