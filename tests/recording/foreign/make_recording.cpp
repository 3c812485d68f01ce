// SPDX-License-Identifier: MIT
// make_recording <out.mcap> [zstd]: records six seconds of a simulated G4 in virtual time, and
// prints what other programs must find in the file, one item per line.
#include <cinttypes>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/grid.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/recording/writer.hpp"
#include "support/virtual_transport.hpp"

namespace {

using namespace g4lidar;
using namespace std::chrono_literals;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t wall_ahead_ns = 1'700'000'000 * second;
constexpr std::size_t bins = 360;

int fail(const error& why) {
  std::fprintf(stderr, "%s\n", why.message().c_str());
  return 1;
}

void print_scan(const scan& of) {
  std::vector<float> ranges(bins);
  fill_grid(of.points, ranges, {.to = frame::robot});
  std::printf("scan %" PRId64, of.points.front().time_ns + wall_ahead_ns);
  for (const float range : ranges) std::printf(" %a", static_cast<double>(range));
  std::printf("\n");
}

int run(const std::string& path, bool packed) {
  recording_options how;
  how.packed = packed ? packing::zstd : packing::none;
  how.scan_bins = bins;
  how.frame_id = "lidar_frame";
  how.overwrite = true;
  auto writer = recording_writer::create(path, how);
  if (!writer) return fail(writer.error());
  writer->set_wall_clock(wall_ahead_ns);
  test::virtual_bench bench;
  auto from = recorded(std::make_unique<test::virtual_connector>(bench), *writer);
  if (!from) return fail(from.error());
  auto device = lidar::open(std::move(*from));
  if (!device) return fail(device.error());
  recorded_device known;
  known.information = device->information();
  writer->device(known);
  if (auto started = device->start(); !started) return fail(started.error());
  while (bench.now_ns < 6 * second) {
    const auto found = device->try_scan(1000ms);
    if (!found) continue;
    writer->points(found->points);
    writer->scan(*found);
    print_scan(*found);
  }
  if (auto closed = device->close(); !closed) return fail(closed.error());
  if (auto closed = writer->close(); !closed) return fail(closed.error());
  const recording_counts counts = writer->counts();
  std::printf("from_device %" PRIu64 " %" PRIu64 "\n", counts.readings, counts.bytes_from_device);
  std::printf("to_device %" PRIu64 "\n", counts.bytes_to_device);
  std::printf("chunks %" PRIu64 "\n", counts.chunks);
  std::printf("payload %016" PRIx64 "\n", writer->digest().payload);
  return 0;
}

}  // namespace

int main(int count, char** words) {
  if (count < 2) return 2;
  return run(words[1], count > 2 && std::string_view(words[2]) == "zstd");
}
