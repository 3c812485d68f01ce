// SPDX-License-Identifier: MIT
// search_bench [RUNS]: By how much the search for an unnamed model delays its first scan, in virtual time, so that each
// run gives the same. Prints a table; fails if the 90th percentile is above the promise. See ../search.sh.
#include <cstdio>
#include <cstdlib>

#include "discovery/first_scan.hpp"

namespace {

using namespace g4lidar;

constexpr double promised_ms = 600.0;
constexpr double as_ms = 1e-6;

/// Whether the promise is kept.
bool print_row(const model& which, bool is_sending, int runs) {
  const test::search_delay delay = test::delay_of_search(which, is_sending, runs);
  const double added_ms = static_cast<double>(delay.added_ns) * as_ms;
  const bool is_kept = delay.good && added_ms <= promised_ms;
  std::printf("| %s, %s | %u | %.0f | %.0f | %.0f%s |\n", which.name.data(),
              is_sending ? "scanning" : "idle", which.bauds[0],
              static_cast<double>(delay.named_ns) * as_ms,
              static_cast<double>(delay.unnamed_ns) * as_ms, added_ms,
              !delay.good ? ", no scan"
              : is_kept   ? ""
                          : ", missed");
  return is_kept;
}

}  // namespace

int main(int count, char** words) {
  const int runs = count > 1 ? std::atoi(words[1]) : 20;
  if (runs < 1) return EXIT_FAILURE;
  std::printf(
      "Milliseconds from the opening of the port to the first scan: medians of %d, and the 90th "
      "percentile of "
      "what the search adds (promised: at most %.0f)\n\n| model | baud | named | unnamed | added "
      "|\n"
      "|---|---|---|---|---|\n",
      runs, promised_ms);
  bool all_kept = true;
  for (const model& each : models) {
    for (const bool is_sending : {false, true}) all_kept &= print_row(each, is_sending, runs);
  }
  return all_kept ? EXIT_SUCCESS : EXIT_FAILURE;
}
