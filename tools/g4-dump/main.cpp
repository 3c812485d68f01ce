// SPDX-License-Identifier: MIT
// g4-dump: the verb of the command line is run, and what goes wrong becomes a sentence.
#include <exception>
#include <string>
#include <variant>

#include "command_line.hpp"
#include "exit_code.hpp"
#include "interrupt.hpp"
#include "say.hpp"

namespace g4_dump {
namespace {

int run(nothing_to_do done) { return done.code; }

int say_failure(const char* sentences, exit_code code) {
  say(std::string("g4-dump: ") + sentences + "\n");
  return static_cast<int>(code);
}

}  // namespace
}  // namespace g4_dump

int main(int argc, char** argv) {
  using namespace g4_dump;
  try {
    prepare_process();
    return std::visit([](const auto& wanted) { return run(wanted); },
                      read_command_line(argc, argv));
  } catch (const interrupted&) {
    return 128 + interrupt();
  } catch (const failure& reason) {
    return say_failure(reason.what(), reason.code());
  } catch (const std::exception& reason) {
    return say_failure(reason.what(), exit_code::bad_file);
  }
}
