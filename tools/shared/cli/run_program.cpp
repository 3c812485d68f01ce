// SPDX-License-Identifier: MIT
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "cli/common_options.hpp"
#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/verbs.hpp"
#include "io/interrupt.hpp"

namespace g4_tool {
namespace {

const program* running = nullptr;

std::vector<std::string>& words_of_run() noexcept {
  static std::vector<std::string> words;
  return words;
}

}  // namespace

const program& this_program() noexcept { return *running; }

const std::vector<std::string>& command_line() noexcept { return words_of_run(); }

int run_program(const program& run, int argc, const char* const* argv) noexcept {
  running = &run;
  try {
    words_of_run().assign(argv + 1, argv + argc);  // NOLINT: the length is given
    prepare_process();
    return read_command_line(argc, argv)();
  } catch (const interrupted&) {
    return 128 + interrupt();
  } catch (const failure& reason) {
    logger::error(reason.what(), reason.code(), reason.problem());
    return static_cast<int>(reason.code());
  } catch (const std::bad_alloc&) {
    // These messages need no memory.
    if (our_global_options().json_errors) {
      logger::write("{\"error\":\"out of memory\",\"exit_code\":11}\n");
    } else {
      logger::write(run.name);
      logger::write(": out of memory\n");
    }
  } catch (const std::exception& reason) {
    logger::error(std::string("internal error: ") + reason.what(), exit_code::internal);
  }
  return static_cast<int>(exit_code::internal);
}

}  // namespace g4_tool
