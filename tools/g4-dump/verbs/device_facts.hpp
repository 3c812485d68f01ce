// SPDX-License-Identifier: MIT
// What the verbs list and info print, for a report of a problem, too.
#pragma once

#include "cli/common_options.hpp"
#include "io/output.hpp"

namespace g4_tool {

/// The table of list, of all ports; without asking a device.
void write_ports(output& out);
/// The lines of info. Throws a failure.
void write_facts(const common_options& options, output& out);

}  // namespace g4_tool
