// SPDX-License-Identifier: MIT
// The verb sim: writes the bytes of a simulated lidar, or serves simulated devices.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "cli/option_rows.hpp"
#include "export/digits.hpp"
#include "export/protocol_log.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "sim.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

void check(const sim_options& options) {
  if (const auto problem = problem_with(options.setup.device); !problem.empty()) {
    throw bad_value(std::string(problem));
  }
  if (options.odometry_file.empty() && options.has_odometry_options) {
    throw bad_value(
        "--odometry-rate, --way-noise, --turn-noise, --way-slip and --turn-slip need --odometry");
  }
  if (const auto problem = problem_with(options.odometry); !problem.empty()) {
    throw bad_value(std::string(problem));
  }
  if (options.devices() == 0 && options.has_device_options) {
    throw bad_value("--serial, --fault, --device and --log need --link, --tcp or --register");
  }
  if (options.serials.size() > options.devices()) {
    throw bad_value("there are more --serial than devices (--link, --tcp, --register)");
  }
}

/// The opened port; throws a failure for an error. `advice` is for a place that is in use.
sim::pty_port opened(result<sim::pty_port> port, const std::string& place,
                     std::string_view advice) {
  if (port) return *std::move(port);
  if (port.error().code() != g4lidar::problem::busy) {
    throw failure(exit_code::bad_file, in_tool_words(port.error().message()));
  }
  const bool is_served = port.error().system_errno() == EADDRINUSE;
  throw failure(is_served ? exit_code::busy : exit_code::bad_file,
                fmt::format("{} {}. {}", place,
                            is_served ? "leads to a device that another program simulates"
                                      : "exists and is not a link to a pseudo-terminal",
                            advice));
}

/// Opens the links, then the registered link, then the bridges.
std::vector<sim::pty_port> open_ports(const sim_options& options,
                                      const std::vector<sim::device_options>& devices) {
  const sim::world scene = load_scene(options.setup);
  std::vector<std::string> links = options.links;
  if (options.is_registered) {
    links.push_back(sim::registered_link(devices[links.size()].info.serial_number()));
    if (links.back().empty()) {
      throw bad_value(
          "--register: set the environment variable G4LIDAR_SIM_DIR to a directory, here and for "
          "the programs that are to discover the lidar");
    }
  }
  std::vector<sim::pty_port> ports;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    sim::device simulated(scene, devices[i], options.setup.faults);
    const bool has_link = i < links.size();
    const auto& [address, port] =
        has_link ? std::pair(links[i], std::uint16_t{0}) : options.bridges[i - links.size()];
    const char* const advice = i < options.links.size()
                                   ? "Give another path for --link."
                                   : "Give another --serial, or another G4LIDAR_SIM_DIR.";
    ports.push_back(opened(has_link ? sim::pty_port::open(std::move(simulated), address)
                                    : sim::pty_port::listen(std::move(simulated), address, port),
                           address, advice));
    const std::string& path = ports.back().path();
    const g4lidar::model* const served = g4lidar::model_named(devices[i].model);
    logger::write(fmt::format("{} {} at {}\n", served == nullptr ? devices[i].model : served->name,
                              devices[i].info.serial_number(),
                              printable(path.empty() ? address : path)));
  }
  return ports;
}

/// Serves the devices until a signal comes.
int serve(const sim_options& options) {
  const auto devices = sim::several(options.setup.device, options.devices(), options.serials);
  std::vector<sim::pty_port> ports = open_ports(options, devices);
  const auto log = [&] {
    for (std::size_t i = 0; i < ports.size(); ++i) {
      for (const sim::asked& what : ports[i].simulated().log()) {
        if (!options.log) break;
        logger::write(fmt::format(
            "{:.3f} {} A5 {:02X} {}{}{}\n", static_cast<double>(what.time_ns) / 1e9,
            devices[i].info.serial_number(), what.code, word_for_command(what.code),
            what.scanning ? ", while scanning" : "", what.obeyed ? "" : ", not obeyed"));
      }
      ports[i].simulated().clear_log();
    }
  };
  const auto served = sim::serve(ports, interrupt_handle(), log);
  if (!served) throw failure(exit_code::bad_file, in_tool_words(served.error().message()));
  return 128 + interrupt();
}

int run(const sim_options& options) {
  check(options);
  return options.devices() > 0 ? serve(options) : write_stream(options);
}

constexpr const char* sim_details =
    R"(The same options give the same bytes on every computer: the response to the start command, and all
packets that were complete before N seconds. Columns of --truth: index, time_ns, scan,
first_level_deg, bearing_deg (direction of the target), range_mm (its distance, exact; 0: no
target), raw (as sent, of a G4 in quarters of a millimeter), intensity and sample_flags if the
model has them, lidar_x_m, lidar_y_m, lidar_heading_deg (where the lidar was). Lines of
--odometry: time_ns, x and y in m, yaw_rad, counted from where the robot was at time 0.

With --link PATH the command serves a device that answers commands, on a pseudo-terminal to
which the symbolic link PATH leads, until ^C. With --tcp PORT it serves a device for
tcp:HOST:PORT, at 127.0.0.1 unless an ADDRESS such as 0.0.0.0 is given. With --register it serves
a device in the directory that the environment variable G4LIDAR_SIM_DIR names. Programs that have
the same variable discover it there: g4-dump list, serial:NUMBER, and a source that is
left out.)";

/// "NAME=VALUE", as in a source `sim:?NAME=VALUE`.
void set(sim::setup& setup, const std::string& word) {
  if (const std::string wrong = sim::set(setup, word); !wrong.empty()) throw bad_value(wrong);
}

option_rows file_rows(sim_options& options) {
  return {// First: the other options change what it sets.
          {"--model", "MODEL", "The model (g4): x4, t-mini-pro, ...; see docs/sim.md",
           [&options](const std::string& word) { set(options.setup, "model=" + word); }},
          number_row("--seconds", "N", "Duration of the scan (10)", options.seconds, 0.0, 1e9),
          {"--seed", "S", "Seed of the random numbers (1)",
           [&options](const std::string& word) { set(options.setup, "seed=" + word); }},
          text_row("-o,--output", "FILE", "Output file; - for standard output (-)", options.output,
                   completion::output),
          text_row("--truth", "FILE", "Write the exact value of each sample, as csv", options.truth,
                   completion::output),
          force_row(),
          text_row("--world", "FILE", "The walls (a flat of a few rooms); see docs/sim.md",
                   options.setup.world_file, completion::input),
          text_row("--path", "FILE", "How the lidar moves (as in the world); see docs/sim.md",
                   options.setup.path_file, completion::input)};
}

option_rows odometry_rows(sim_options& options) {
  sim::odometry_options& how = options.odometry;
  const auto number = [&options](const char* name, const char* value, const char* help,
                                 double& into, double least, double most) {
    return checked(number_row(name, value, help, into, least, most),
                   [&options](const std::string&) { options.has_odometry_options = true; });
  };
  option_rows rows{
      text_row("--odometry", "FILE", "Write the odometry: lines of time_ns, x, y and yaw_rad",
               options.odometry_file, completion::output),
      number("--odometry-rate", "HZ", "Poses per second (50)", how.rate_hz, 0.1, 1000.0),
      number("--way-noise", "RATIO", "Standard deviation of the odometry after 1 m (0)",
             how.way_noise, 0.0, 1.0),
      number("--turn-noise", "RATIO", "The same after a turn by 90 degrees (0)", how.turn_noise,
             0.0, 1.0),
      number("--way-slip", "RATIO", "Share by which each way is counted too long (0)", how.way_slip,
             -0.5, 0.5),
      number("--turn-slip", "RATIO", "Share by which each turn is counted too far (0)",
             how.turn_slip, -0.5, 0.5)};
  return in_group("Odometry of a lidar that moves", rows);
}

/// The sample rate of the model with this number of samples per second.
sample_rate rate_of(const std::string& word, const sim::wire_format& format) {
  std::vector<std::string> known;
  for (const std::uint32_t hz : format.rates_hz) {
    if (hz != 0) known.push_back(std::to_string(hz));
  }
  const auto found = std::ranges::find(known, word);
  if (found == known.end()) {
    throw bad_value(fmt::format("'{}' is not one of {}", word, fmt::join(known, ", ")));
  }
  return static_cast<sample_rate>(format.rates_hz[static_cast<std::size_t>(found - known.begin())]);
}

option_rows scanner_rows(sim::scanner_options& scanner) {
  const auto number = [](const char* name, const char* value, const char* help, auto& into) {
    return number_row(name, value, help, into, -1e9, 1e9);
  };
  const auto centihertz = [](const std::string& word) {
    return static_cast<std::uint16_t>(number_of(word, 3.0, 16.0) * 100.0 + 0.5);
  };
  return {value_row("--frequency", "HZ", "Revolutions per second, of a G4 5 to 12 (7)",
                    scanner.scan_frequency_chz, centihertz),
          value_row("--sample-rate", "HZ", "Samples per second, of a G4 4000, 8000 or 9000 (9000)",
                    scanner.sample_rate,
                    [&scanner](const std::string& word) { return rate_of(word, scanner.format); }),
          number_row("--samples", "N", "Samples in a packet, 1 to 80, or 40 by the model (40)",
                     scanner.samples_per_packet, std::size_t{1}, std::size_t{80}),
          number("--start-deg", "DEG", "Angle of the first sample (random)", scanner.start_deg),
          number("--index-deg", "DEG", "Angle at which a revolution starts (0)", scanner.index_deg),
          number("--noise-mm", "MM", "Standard deviation of each range (0)", scanner.noise_mm),
          number("--noise-ratio", "RATIO", "Standard deviation to add for each mm of range (0)",
                 scanner.noise_ratio),
          number("--dropout", "RATIO", "Share of samples without a return, 0 to 1 (0)",
                 scanner.dropout_ratio),
          value_row("--no-reported-frequency", "", "Packets do not report the scan frequency",
                    scanner.reports_frequency, [](const std::string&) { return false; })};
}

/// The address and the port of "4000" or "0.0.0.0:4000".
std::pair<std::string, std::uint16_t> tcp_place_of(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const bool has_address = colon != std::string::npos;
  try {
    return {has_address ? text.substr(0, colon) : "127.0.0.1",
            number_of(text.substr(has_address ? colon + 1 : 0), std::uint16_t{0},
                      std::uint16_t{65'535})};
  } catch (const bad_value&) {
    throw bad_value(in_quotes(text) + " is not PORT or ADDRESS:PORT");
  }
}

void add_new(std::vector<std::string>& all, const std::string& word) {
  if (std::ranges::find(all, word) != all.end()) {
    throw bad_value(in_quotes(word) + " is given twice");
  }
  all.push_back(word);
}

/// The options that make it serve devices.
option_rows served_rows(sim_options& options) {
  const auto listed = [](const char* name, const char* value, const char* help, auto take,
                         completion complete = completion::nothing) {
    return option_row{name, value, help, std::move(take), complete, true};
  };
  option_rows places{
      listed(
          "--link", "PATH", "Serve a device at this path; repeat for more devices",
          [&options](const std::string& word) {
            add_new(options.links, std::filesystem::path(word).lexically_normal().string());
          },
          completion::output),
      listed(
          "--tcp", "PORT", "Serve a device at [ADDRESS:]PORT, as a network bridge does",
          [&options](const std::string& word) { options.bridges.push_back(tcp_place_of(word)); }),
      flag_row("--register", "Serve a device where list and serial: find it",
               options.is_registered)};
  for (option_row& row : places) row.excludes = {"--seconds", "--output", "--truth", "--odometry"};
  option_rows of_devices{
      listed("--serial", "DIGITS", "Serial numbers of the devices, in turn: 16 digits each",
             [&options](const std::string& word) {
               sim::setup unused;
               set(unused, "serial=" + word);
               add_new(options.serials, word);
             }),
      listed(
          "--fault", "FAULT", "KIND[=AMOUNT][*RATE][@BEGIN[+DURATION]]; see docs/sim.md",
          [&options](const std::string& word) {
            try {
              set(options.setup, "fault=" + word);
            } catch (const bad_value& reason) {
              throw bad_value(
                  reason.what() +
                  did_you_mean(word.substr(0, word.find_first_of("=*@")), fault_names()));
            }
          },
          completion::fault),
      listed("--device", "NAME=VALUE", "An option of the devices; see docs/sim_device.md",
             [&options](const std::string& word) { set(options.setup, word); }),
      flag_row("--log", "Write the commands to standard error", options.log)};
  for (option_row& row : of_devices) {
    row = checked(std::move(row),
                  [&options](const std::string&) { options.has_device_options = true; });
  }
  return in_group("Devices in real time", joined(places, of_devices));
}

}  // namespace

verb make_sim_verb() {
  const auto options = std::make_shared<sim_options>();
  return {
      .name = "sim",
      .summary = "Simulate a lidar: write its bytes, or serve a device",
      .options = joined(file_rows(*options), scanner_rows(options->setup.device.scanner),
                        odometry_rows(*options), served_rows(*options)),
      .details = sim_details,
      .examples =
          {{"g4-dump sim --seconds 60 --seed 7 -o room.bin --truth room.csv",
            "A minute of raw bytes, and their exact values"},
           {"g4-dump sim --seconds 5 --noise-mm 8 --dropout 0.02 | g4-dump decode --format text",
            "Print the points of a noisy lidar"},
           {"g4-dump sim --seconds 90 --world office.txt --odometry way.txt -o office.bin",
            "Drive through a world whose file has a path, and write the odometry"},
           {"g4-dump sim --link /tmp/lidar --log", "Serve a device at /tmp/lidar"},
           {"G4LIDAR_SIM_DIR=/tmp/g4 g4-dump sim --register",
            "Serve a device for G4LIDAR_SIM_DIR=/tmp/g4 g4-dump list --probe"},
           {"g4-dump sim --link /tmp/front --link /tmp/rear --fault unplug@5s+2s "
            "--fault 'flip*0.01%'",
            "Serve two devices with faults"}},
      .exits = {0, 2, 10, 11, 130},
      .run = [options] { return run(*options); }};
}

}  // namespace g4_tool
