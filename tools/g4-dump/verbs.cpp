// SPDX-License-Identifier: MIT
#include "verbs.hpp"

#include "exit_code.hpp"

namespace g4_dump {

std::vector<verb> all_verbs() {
  std::vector<verb> verbs;
  verbs.push_back(make_list_verb());
  verbs.push_back(make_watch_verb());
  verbs.push_back(make_info_verb());
  verbs.push_back(make_health_verb());
  verbs.push_back(make_stats_verb());
  verbs.push_back(make_doctor_verb());
  verbs.push_back(make_dump_verb());
  verbs.push_back(make_scan_verb());
  verbs.push_back(make_packets_verb());
  verbs.push_back(make_decode_verb());
  verbs.push_back(make_sim_verb());
  verbs.push_back(make_set_verb());
  verbs.push_back(make_start_verb());
  verbs.push_back(make_stop_verb());
  verbs.push_back(make_restart_verb());
  verbs.push_back(make_record_verb());
  verbs.push_back(make_replay_verb());
  verbs.push_back(make_convert_verb());
  return verbs;
}

const std::vector<exit_code_row>& exit_codes() {
  static const std::vector<exit_code_row> rows{
      {static_cast<int>(exit_code::ok), "well"},
      {static_cast<int>(exit_code::usage), "wrong command line"},
      {static_cast<int>(exit_code::no_device), "no device"},
      {static_cast<int>(exit_code::permission), "no permission"},
      {static_cast<int>(exit_code::busy), "busy: another program has it"},
      {static_cast<int>(exit_code::silent), "silent, or a wrong baud rate"},
      {static_cast<int>(exit_code::not_a_g4), "not a G4"},
      {static_cast<int>(exit_code::unhealthy), "unhealthy"},
      {static_cast<int>(exit_code::lost), "lost while running"},
      {static_cast<int>(exit_code::bad_file), "bad file"},
      {130, "after ^C (128 and the number of the signal)"},
  };
  return rows;
}

}  // namespace g4_dump
