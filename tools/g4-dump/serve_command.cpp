// SPDX-License-Identifier: MIT
// One device for each link, all in one loop; what they are asked goes to standard error.
#include "serve_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "command_words.hpp"
#include "exit_code.hpp"
#include "g4lidar/sim/pty_port.hpp"
#include "interrupt.hpp"
#include "say.hpp"

namespace g4_dump {
namespace {

namespace sim = g4lidar::sim;

void say_asked(const sim::asked& what, const std::string& serial) {
  say(fmt::format("{:.3f} {} A5 {:02X} {}{}{}\n", static_cast<double>(what.time_ns) / 1e9, serial,
                  what.code, word_for_command(what.code), what.scanning ? ", while scanning" : "",
                  what.obeyed ? "" : ", not obeyed"));
}

[[noreturn]] void refuse(const std::string& problem) {
  throw failure(exit_code::usage, fmt::format("{}. See: g4-dump sim --help", problem));
}

std::vector<sim::fault> read_faults(const sim_options& options) {
  std::vector<sim::fault> faults;
  for (const std::string& text : options.faults) {
    const auto read = sim::parse_fault(text);
    if (const auto* wrong = std::get_if<sim::fault_error>(&read)) {
      refuse(fmt::format("--fault {}: {}", text, wrong->message));
    }
    faults.push_back(std::get<sim::fault>(read));
  }
  return faults;
}

// Those that were given, and others for the rest: no two are alike.
std::vector<std::string> serials_for(const sim_options& options) {
  std::vector<std::string> serials = options.serials;
  std::uint64_t next = 2'021'101'000'070'073;
  while (serials.size() < options.links.size()) {
    std::string serial = std::to_string(next++);
    if (std::find(serials.begin(), serials.end(), serial) == serials.end()) {
      serials.push_back(std::move(serial));
    }
  }
  return serials;
}

sim::device_options options_of(const sim_options& options, std::size_t which,
                               const std::string& serial) {
  sim::device_options made;
  made.scanner = options.scanner;
  made.scanner.seed += which;
  std::copy(serial.begin(), serial.end(), made.info.serial_digits.begin());
  return made;
}

}  // namespace

void refuse_nonsense_to_serve(const sim_options& options) {
  std::vector<std::filesystem::path> seen;
  for (const std::string& link : options.links) {
    const auto plain = std::filesystem::path(link).lexically_normal();
    if (std::find(seen.begin(), seen.end(), plain) != seen.end()) {
      refuse(fmt::format("--link {} is given twice", link));
    }
    seen.push_back(plain);
  }
  if (options.serials.size() > options.links.size()) {
    refuse("there are more --serial than --link");
  }
  for (std::size_t i = 0; i < options.serials.size(); ++i) {
    const std::string& serial = options.serials[i];
    const bool digits =
        std::all_of(serial.begin(), serial.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (serial.size() != 16 || !digits) {
      refuse(fmt::format("--serial {}: a serial number has 16 decimal digits", serial));
    }
    const auto behind = options.serials.begin() + static_cast<std::ptrdiff_t>(i) + 1;
    if (std::find(behind, options.serials.end(), serial) != options.serials.end()) {
      refuse(fmt::format("--serial {} is given twice", serial));
    }
  }
  [[maybe_unused]] const auto readable = read_faults(options);
}

int serve(const sim_options& options, const sim::world& scene) {
  const std::vector<sim::fault> faults = read_faults(options);
  const std::vector<std::string> serials = serials_for(options);
  std::vector<sim::pty_port> ports;
  for (std::size_t i = 0; i < options.links.size(); ++i) {
    auto port = sim::pty_port::open(sim::device(scene, options_of(options, i, serials[i]), faults),
                                    options.links[i]);
    if (!port && port.error().what() == g4lidar::problem::busy) {
      throw failure(exit_code::bad_file,
                    fmt::format("{} is there already, and no link to a pseudo-terminal. Give a "
                                "path for --link where nothing is.",
                                options.links[i]));
    }
    if (!port) throw failure(exit_code::bad_file, port.error().message());
    ports.push_back(std::move(*port));
    say(fmt::format("G4 {} at {}\n", serials[i], options.links[i]));
  }
  const auto tell = [&] {
    for (std::size_t i = 0; i < ports.size(); ++i) {
      if (options.log) {
        for (const sim::asked& what : ports[i].twin().log()) say_asked(what, serials[i]);
      }
      ports[i].twin().clear_log();
    }
  };
  const auto served = sim::serve(ports, interrupt_handle(), tell);
  if (!served) throw failure(exit_code::bad_file, served.error().message());
  return 128 + interrupt();
}

}  // namespace g4_dump
