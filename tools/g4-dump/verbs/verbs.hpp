// SPDX-License-Identifier: MIT
// The verbs of g4-dump. Each is made in a file of its own.
#pragma once

#include <vector>

#include "cli/verbs.hpp"

namespace g4_tool {

[[nodiscard]] verb make_list_verb();
[[nodiscard]] verb make_watch_verb();
[[nodiscard]] verb make_info_verb();
[[nodiscard]] verb make_health_verb();
[[nodiscard]] verb make_stats_verb();
[[nodiscard]] verb make_dump_verb();
[[nodiscard]] verb make_scan_verb();
[[nodiscard]] verb make_doctor_verb();
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
[[nodiscard]] verb make_view_verb();  ///< Where there is ncursesw.

/// All of them, in the order of the help.
[[nodiscard]] std::vector<verb> all_verbs();

/// The ports with a G4, as far as that can be known without sending anything, and the commands. Returns
/// the exit code.
[[nodiscard]] int print_overview();

}  // namespace g4_tool
