// SPDX-License-Identifier: MIT
// The self-test of the core: the same source on a microcontroller and on the host.
#include <array>

#include "check.hpp"

namespace self_test {

void put_number(std::size_t number) {
  std::array<char, 20> digits{};
  std::size_t first = digits.size();
  do {
    digits[--first] = static_cast<char>('0' + static_cast<int>(number % 10));
    number /= 10;
  } while (number > 0);
  put({digits.data() + first, digits.size() - first});
}

bool check(bool ok, std::source_location at) {
  if (ok) {
    ++result.passed;
    return true;
  }
  ++result.failed;
  const std::string_view path = at.file_name();
  put(path.substr(path.rfind('/') + 1));
  put(":");
  put_number(at.line());
  put(": failed\n");
  return false;
}

namespace {

void run(std::string_view name, void (*suite)()) {
  const tally before = result;
  suite();
  put(name);
  put(": ");
  put_number(result.passed - before.passed);
  put(" passed, ");
  put_number(result.failed - before.failed);
  put(" failed\n");
}

}  // namespace
}  // namespace self_test

int main() {
  using namespace self_test;
  run("worked examples", test_worked_examples);
  run("transcripts", test_transcripts);
  run("points", test_points);
  run("ring", test_ring);
  run("scans", test_scans);
  run("session", test_session);
  run("board", test_board);
#ifdef G4LIDAR_SELF_TEST_FAULT
  check(unknown(1) == 2);  // a run with a fault must fail
#endif
  put_number(result.passed);
  put(" passed, ");
  put_number(result.failed);
  put(" failed\n");
  return result.failed == 0 && result.passed > 0 ? 0 : 1;
}
