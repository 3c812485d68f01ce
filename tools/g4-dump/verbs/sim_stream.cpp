// SPDX-License-Identifier: MIT
// Writes the stream of a simulated lidar, its true values and its odometry.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "cli/exit_code.hpp"
#include "export/digits.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "io/interrupt.hpp"
#include "io/output.hpp"
#include "io/source_word.hpp"
#include "sim.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
namespace {

void write_truth(std::span<const sim::sample_truth> samples, bool has_more, output& out) {
  using namespace digits;
  constexpr std::size_t max_row = 240;
  for (const sim::sample_truth& sample : samples) {
    char* at = out.room(max_row);
    const auto put = [&at](char* end) {
      at = end;
      *at++ = ',';
    };
    put(put_number(at, sample.index));
    put(put_number(at, static_cast<std::uint64_t>(sample.time_ns)));
    put(put_number(at, sample.revolution));
    put(put_angle<6>(at, sample.first_level_deg));
    put(put_angle<6>(at, sample.bearing_deg));
    put(put_fixed<3>(at, sample.range_mm));
    put(put_number(at, sample.raw));
    if (has_more) {
      put(put_number(at, sample.intensity));
      put(put_number(at, sample.flags));
    }
    const sim::pose& lidar = sample.lidar;
    const double turns = std::floor(lidar.heading_deg / 360.0);
    out.wrote(fmt::format_to(at, "{:.6f},{:.6f},{:.6f}\n", lidar.x_m, lidar.y_m,
                             lidar.heading_deg - 360.0 * turns));
  }
}

/// Writes lines "time_ns x y yaw_rad".
void write_odometry(const sim::world& scene, const sim_options& options, std::int64_t end_ns,
                    output& out) {
  sim::odometry_options how = options.odometry;
  how.seed = options.setup.device.scanner.seed;
  sim::odometry odometry(scene, how);
  constexpr std::size_t max_row = 120;
  while (odometry.next_ns() < end_ns && interrupt() == 0) {
    const sim::odometry_sample sample = odometry.next();
    out.wrote(fmt::format_to(out.room(max_row), "{} {:.6f} {:.6f} {:.6f}\n", sample.time_ns,
                             sample.x_m, sample.y_m, sample.yaw_rad));
  }
}

}  // namespace

int write_stream(const sim_options& options) {
  output out(options.output);
  if (out.is_terminal()) {
    throw failure(exit_code::usage,
                  "raw bytes are not for a terminal. Give a file with -o FILE, or a pipe: "
                  "g4-dump sim | g4-dump decode");
  }
  const sim::device_options& device = options.setup.device;
  const sim::sample_code& code = device.scanner.format.code;
  const bool has_more = code.brightest() != 0 || code.lower == sim::lower_bits::flags;
  std::optional<output> truth;
  if (!options.truth.empty()) {
    truth.emplace(options.truth);
    truth->write("index,time_ns,scan,first_level_deg,bearing_deg,range_mm,raw,");
    if (has_more) truth->write("intensity,sample_flags,");
    truth->write("lidar_x_m,lidar_y_m,lidar_heading_deg\n");
  }
  std::optional<output> way;
  if (!options.odometry_file.empty()) way.emplace(options.odometry_file);
  const auto write = [&out](g4lidar::bytes data) {
    out.write({reinterpret_cast<const char*>(data.data()), data.size()});
  };
  const sim::world scene = load_scene(options.setup);
  sim::scanner scanner(scene, sim::scanner_of(device));
  const auto end_ns = static_cast<std::int64_t>(std::llround(options.seconds * 1e9));
  write(sim::scan_start_reply());
  while (interrupt() == 0 && !out.is_closed()) {
    const sim::sent_packet packet = scanner.next();
    if (packet.complete_ns >= end_ns) break;
    const bool is_zero = (packet.data[2] & 1U) != 0;
    if (device.ct_crc && is_zero) write({&packet.crc, 1});
    write(packet.data);
    if (truth) write_truth(packet.samples, has_more, *truth);
  }
  if (way) write_odometry(scene, options, end_ns, *way);
  // Files of an interrupted simulation are not kept, because it can be repeated.
  if (interrupt() != 0) {
    if (options.output == "-") out.flush();
    return 128 + interrupt();
  }
  if (truth) truth->commit();
  if (way) way->commit();
  out.commit();
  return static_cast<int>(exit_code::ok);
}

}  // namespace g4_tool
