// SPDX-License-Identifier: MIT
#include "verbs.hpp"

namespace g4_dump {

std::vector<verb> all_verbs() {
  return {make_list_verb(),    make_watch_verb(),  make_info_verb(),    make_health_verb(),
          make_stats_verb(),   make_doctor_verb(), make_dump_verb(),    make_scan_verb(),
          make_packets_verb(), make_decode_verb(), make_sim_verb(),     make_set_verb(),
          make_start_verb(),   make_stop_verb(),   make_restart_verb(), make_record_verb(),
          make_replay_verb(),  make_convert_verb()};
}

option_rows standard_rows() {
  return {{"-h,--help", "", "Print a help message and exit"},
          {"--version", "", "Print the version and exit"}};
}

}  // namespace g4_dump
