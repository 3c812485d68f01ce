// SPDX-License-Identifier: MIT
// g4-dump: the verb of the command line is run, and what goes wrong becomes a sentence.
#include <exception>

#include "command_line.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "report.hpp"

int main(int argc, char** argv) {
  using namespace g4_dump;
  try {
    prepare_process();
    return read_command_line(argc, argv)();
  } catch (const interrupted&) {
    return 128 + interrupt();
  } catch (const failure& reason) {
    report(reason.what(), reason.code(), reason.problem());
    return static_cast<int>(reason.code());
  } catch (const std::exception& reason) {
    report(reason.what(), exit_code::bad_file);
    return static_cast<int>(exit_code::bad_file);
  }
}
