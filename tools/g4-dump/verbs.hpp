// SPDX-License-Identifier: MIT
// Every verb of g4-dump, in the order of the help. Each is made in the file of its command.
#pragma once

#include <vector>

#include "verb.hpp"

namespace g4_dump {

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

/// All of them. What they share with their options lives as long as they do.
[[nodiscard]] std::vector<verb> all_verbs();

/// The exit codes and what they mean, for the help and the man page.
struct exit_code_row {
  int code;
  const char* meaning;
};
[[nodiscard]] const std::vector<exit_code_row>& exit_codes();

}  // namespace g4_dump
