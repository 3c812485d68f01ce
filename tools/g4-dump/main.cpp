// SPDX-License-Identifier: MIT
// g4-dump: runs the verb of the command line and reports errors.
#include <exception>
#include <new>
#include <string>

#include "cli/common_options.hpp"
#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/verbs.hpp"
#include "io/interrupt.hpp"

int main(int argc, char** argv) {
  using namespace g4_dump;
  try {
    prepare_process();
    return read_command_line(argc, argv)();
  } catch (const interrupted&) {
    return 128 + interrupt();
  } catch (const g4_dump::failure& reason) {
    logger::error(reason.what(), reason.code(), reason.problem());
    return static_cast<int>(reason.code());
  } catch (const std::bad_alloc&) {
    // Nothing is allocated for this.
    logger::write(our_global_options().json_errors
                      ? "{\"error\":\"out of memory\",\"exit_code\":11}\n"
                      : "g4-dump: out of memory\n");
  } catch (const std::exception& reason) {
    logger::error(std::string("internal error: ") + reason.what(), exit_code::internal);
  }
  return static_cast<int>(exit_code::internal);
}
