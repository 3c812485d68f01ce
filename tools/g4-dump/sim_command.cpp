// SPDX-License-Identifier: MIT
// Options to a scanner, its packets to a file, and what they truly were to another.
#include "sim_command.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <variant>

#include "digits.hpp"
#include "exit_code.hpp"
#include "g4lidar/sim/world.hpp"
#include "input.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "serve_command.hpp"

namespace g4_dump {
namespace {

std::string read_all(input& in) {
  constexpr std::size_t most = std::size_t{16} * 1024 * 1024;
  std::string text;
  std::array<std::uint8_t, 16'384> part;
  while (const std::size_t count = in.read(part)) {
    text.append(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(count));
    if (text.size() > most) {
      throw failure(exit_code::bad_file,
                    in.title() + " is too long for a world: at most 16 MB and 10,000 walls.");
    }
  }
  return text;
}

void write(g4lidar::bytes data, output& out) {
  char* at = out.room(data.size());
  for (const std::uint8_t byte : data) *at++ = static_cast<char>(byte);
  out.wrote(at);
}

void write(std::span<const g4lidar::sim::sample_truth> samples, output& out) {
  constexpr std::size_t max_row = 160;
  for (const g4lidar::sim::sample_truth& sample : samples) {
    char* at = put_number(out.room(max_row), sample.index);
    *at++ = ',';
    at = put_number(at, static_cast<std::uint64_t>(sample.time_ns));
    *at++ = ',';
    at = put_number(at, sample.revolution);
    *at++ = ',';
    at = put_angle<6>(at, sample.first_level_deg);
    *at++ = ',';
    at = put_angle<6>(at, sample.bearing_deg);
    *at++ = ',';
    at = put_fixed<3>(at, sample.range_mm);
    *at++ = ',';
    at = put_number(at, sample.raw);
    *at++ = '\n';
    out.wrote(at);
  }
}

void refuse_nonsense(const sim_options& options) {
  const auto refuse = [](std::string_view problem) {
    throw failure(exit_code::usage, fmt::format("{}. See: g4-dump sim --help", problem));
  };
  if (const auto problem = problem_with(options.scanner); !problem.empty()) refuse(problem);
  const auto plain = [](const std::string& name) {
    return std::filesystem::path(name).lexically_normal();
  };
  if (options.truth && plain(*options.truth) == plain(options.output)) {
    refuse("--truth and -o name the same place");
  }
}

}  // namespace

g4lidar::sim::world load_world(const sim_options& options, const output* out) {
  if (!options.world) return g4lidar::sim::built_in_world();
  input in(*options.world, "Give a text file of walls, or leave --world out for a built-in flat.");
  if (out != nullptr) refuse_same_file(in.id(), *out);
  const auto read = g4lidar::sim::parse_world(read_all(in));
  if (const auto* error = std::get_if<g4lidar::sim::world_error>(&read)) {
    const std::string where = error->line > 0 ? fmt::format(", line {}", error->line) : "";
    throw failure(exit_code::bad_file,
                  fmt::format("{}{}: {}. docs/sim.md has the format of worlds.", in.title(), where,
                              error->message));
  }
  return std::get<g4lidar::sim::world>(read);
}

int run(const sim_options& options) {
  refuse_nonsense(options);
  if (!options.links.empty()) {
    refuse_nonsense_to_serve(options);
    return serve(options, load_world(options, nullptr));
  }
  output out(options.output);
  if (out.is_terminal()) {
    throw failure(exit_code::usage,
                  "the bytes of a lidar do no good on a terminal. Give a file with -o FILE, or "
                  "pipe them on: g4-dump sim | g4-dump decode");
  }
  std::optional<output> truth;
  if (options.truth) {
    truth.emplace(*options.truth);
    refuse_same_file(out.id(), *truth);
    truth->write("index,time_ns,scan,first_level_deg,bearing_deg,range_mm,raw\n");
  }
  g4lidar::sim::scanner scanner(load_world(options, &out), options.scanner);
  const auto end_ns = static_cast<std::int64_t>(std::llround(options.seconds * 1e9));
  write(g4lidar::sim::scan_start_reply(), out);
  while (interrupt() == 0 && !out.is_closed()) {
    const g4lidar::sim::sent_packet packet = scanner.next();
    if (packet.complete_ns >= end_ns) break;
    write(packet.data, out);
    if (truth) write(packet.samples, *truth);
  }
  // A simulation that was cut short is worth nothing: it can be made again.
  if (interrupt() != 0) {
    if (options.output == "-") out.flush();
    return 128 + interrupt();
  }
  if (truth) truth->commit();
  out.commit();
  return static_cast<int>(exit_code::ok);
}

}  // namespace g4_dump
