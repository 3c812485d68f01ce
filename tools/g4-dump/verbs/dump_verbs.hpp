// SPDX-License-Identifier: MIT
// The verbs of g4-dump, and what several of them write.
#pragma once

#include <vector>

#include "cli/common_options.hpp"
#include "cli/verbs.hpp"
#include "io/output.hpp"

namespace g4_tool {

[[nodiscard]] verb make_list_verb();
[[nodiscard]] verb make_watch_verb();
[[nodiscard]] verb make_info_verb();
[[nodiscard]] verb make_health_verb();
[[nodiscard]] verb make_stats_verb();
[[nodiscard]] verb make_dump_verb();
[[nodiscard]] verb make_scan_verb();
[[nodiscard]] verb make_doctor_verb();
[[nodiscard]] verb make_acceptance_verb();
[[nodiscard]] verb make_packets_verb();
[[nodiscard]] verb make_decode_verb();
[[nodiscard]] verb make_sim_verb();
[[nodiscard]] verb make_set_verb();
[[nodiscard]] verb make_start_verb();
[[nodiscard]] verb make_stop_verb();
[[nodiscard]] verb make_restart_verb();
[[nodiscard]] verb make_record_verb();
[[nodiscard]] verb make_replay_verb();
[[nodiscard]] verb make_convert_verb();
[[nodiscard]] verb make_serve_verb();
[[nodiscard]] verb make_view_verb();  ///< Only built with ncursesw.

/// All of them, in the order of the help.
[[nodiscard]] std::vector<verb> all_verbs();

/// Prints the ports that may have a lidar, without sending anything, and the commands. Returns the exit code.
[[nodiscard]] int print_overview();

/// The table of list, of all ports, without asking a device.
void write_ports(output& out);
/// The lines of info. Throws a failure.
void write_facts(const common_options& options, output& out);

}  // namespace g4_tool
