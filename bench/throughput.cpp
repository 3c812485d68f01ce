// SPDX-License-Identifier: MIT
// How fast bytes become frames, points and coordinates, compared with memcpy of the same results.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <numbers>
#include <span>
#include <variant>
#include <vector>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/motion/deskew.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"
#include "g4lidar/sim/scanner.hpp"
#include "g4lidar/sim/world.hpp"
#include "recode.hpp"

namespace {

using namespace g4lidar;

// Points in one scan, in the second-level cache, and in memory.
constexpr std::int64_t scan_points = 1'280;
constexpr std::int64_t cache_points = 20'480;
constexpr std::int64_t memory_points = 2'048'000;

struct recording {
  std::vector<std::uint8_t> data;
  std::size_t points = 0;
};

/// The bytes of a simulated G4 with at least `points` points; a minute of them, repeated.
recording make_recording(std::size_t points) {
  static const std::vector<std::vector<std::uint8_t>> packets = [] {
    sim::scanner scanner(sim::built_in_world(), {.noise_mm = 5.0, .dropout_ratio = 0.05});
    std::vector<std::vector<std::uint8_t>> all;
    for (int i = 0; i < 14'000; ++i) {
      const bytes data = scanner.next().data;
      all.emplace_back(data.begin(), data.end());
    }
    return all;
  }();
  recording made;
  for (std::size_t i = 0; made.points < points; i = (i + 1) % packets.size()) {
    made.data.insert(made.data.end(), packets[i].begin(), packets[i].end());
    made.points += packets[i][3];
  }
  return made;
}

void count_bytes(benchmark::State& state, std::size_t each) {
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(each));
}

/// The correction by the formula of the manual, with libm's arctangent.
struct libm_correction {
  double operator()(std::uint16_t raw) const noexcept {
    if (raw < least_range_raw) return 0.0;
    const double range_mm = raw / 4.0;
    return std::atan(21.8 * (155.3 - range_mm) / (155.3 * range_mm)) * 180.0 / std::numbers::pi;
  }
};

template <class Element>
void copy(benchmark::State& state) {
  const std::size_t points = make_recording(static_cast<std::size_t>(state.range(0))).points;
  const std::vector<Element> from(points);
  std::vector<Element> to(points);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), points * sizeof(Element));
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  count_bytes(state, points * sizeof(Element));
}

void parse_in_pieces(benchmark::State& state, std::size_t piece) {
  const recording input = make_recording(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    stream_parser parser;
    std::size_t packets = 0;
    for (bytes rest = input.data; !rest.empty();) {
      const bytes head = rest.first(std::min(piece, rest.size()));
      rest = rest.subspan(head.size());
      parser.feed(head, [&](const event& found) { packets += found.index() == 0 ? 1U : 0U; });
    }
    benchmark::DoNotOptimize(packets);
  }
  count_bytes(state, input.data.size());
}
void parse_whole(benchmark::State& state) { parse_in_pieces(state, SIZE_MAX); }
void parse_by_byte(benchmark::State& state) { parse_in_pieces(state, 1); }

/// Bytes to points by the header-only core, with the correction `Form`.
template <class Form>
void points_by_core(benchmark::State& state) {
  const recording input = make_recording(static_cast<std::size_t>(state.range(0)));
  const auto form = std::make_unique<Form>();
  std::vector<point> out(input.points + max_samples);
  for (auto _ : state) {
    stream_parser parser;
    std::size_t count = 0;
    parser.feed(input.data, [&](const event& found) {
      if (const auto* packet = std::get_if<packet_view>(&found)) {
        const std::span<point, max_samples> here(out.data() + count, max_samples);
        count += decode(*packet, *form, 0, here).points.size();
      }
    });
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  count_bytes(state, input.points * sizeof(point));
}

void points_in_bulk(benchmark::State& state, const model& which) {
  recording input = make_recording(static_cast<std::size_t>(state.range(0)));
  input.data = bench::recoded(input.data, which);
  std::vector<point> out(input.points + max_samples);
  for (auto _ : state) {
    bulk_decoder decoder(which);
    bytes rest = input.data;
    benchmark::DoNotOptimize(decoder.decode(rest, out).size());
    benchmark::ClobberMemory();
  }
  count_bytes(state, input.points * sizeof(point));
  state.SetLabel(name_of(best_instruction_set()));
}

void places_in_bulk(benchmark::State& state) {
  const recording input = make_recording(static_cast<std::size_t>(state.range(0)));
  std::vector<xy_point> out(input.points + max_samples);
  for (auto _ : state) {
    bulk_decoder decoder;
    bytes rest = input.data;
    benchmark::DoNotOptimize(decoder.decode_xy(rest, frame::robot, out).size());
    benchmark::ClobberMemory();
  }
  count_bytes(state, input.points * sizeof(xy_point));
  state.SetLabel(name_of(best_instruction_set()));
}

/// Points of one revolution after another, 9000 a second.
std::vector<point> points_of(std::size_t count) {
  const recording input = make_recording(count);
  std::vector<point> points(input.points + max_samples);
  bulk_decoder decoder;
  bytes rest = input.data;
  points.resize(decoder.decode(rest, points).size());
  std::int64_t time_ns = 1'000'000'000;
  for (point& p : points) p.time_ns = time_ns += 111'111;
  return points;
}

/// Deskews revolutions of 1280 points, each to its first point, by what `motion` gives for it.
template <class Motion>
void deskew_scans(benchmark::State& state, const Motion& motion) {
  const std::vector<point> points = points_of(static_cast<std::size_t>(state.range(0)));
  std::vector<point> out(points.size());
  for (auto _ : state) {
    for (std::size_t at = 0; at < points.size(); at += scan_points) {
      const std::size_t count = std::min<std::size_t>(scan_points, points.size() - at);
      const std::span<const point> scan(points.data() + at, count);
      benchmark::DoNotOptimize(
          deskew(scan, motion, scan.front().time_ns, std::span(out).subspan(at)).outside);
    }
    benchmark::ClobberMemory();
  }
  count_bytes(state, points.size() * sizeof(point));
}
void deskew_twist(benchmark::State& state) { deskew_scans(state, twist_2d{1.0, 0.0, 1.5}); }
/// Poses at 100 Hz.
void deskew_path(benchmark::State& state) {
  std::vector<stamped_pose> path{{0, {}}};
  const std::int64_t end_ns = 2'000'000'000 + state.range(0) * 111'112;
  while (path.back().time_ns < end_ns) {
    path.push_back(
        {path.back().time_ns + 10'000'000, path.back().pose * moved_by({1.0, 0.0, 1.5}, 0.01)});
  }
  deskew_scans(state, std::span<const stamped_pose>(path));
}

void sizes(benchmark::internal::Benchmark* each) {
  for (const std::int64_t points : {scan_points, cache_points, memory_points}) each->Arg(points);
}

BENCHMARK(parse_whole)->Apply(sizes);
BENCHMARK(parse_by_byte)->Arg(cache_points);
BENCHMARK(copy<point>)->Name("copy_points")->Apply(sizes);
BENCHMARK(copy<xy_point>)->Name("copy_places")->Apply(sizes);
BENCHMARK(points_by_core<libm_correction>)->Name("points_libm")->Apply(sizes);
BENCHMARK(points_by_core<exact_correction>)->Name("points_exact")->Apply(sizes);
BENCHMARK(points_by_core<table_correction>)->Name("points_table")->Apply(sizes);
BENCHMARK(points_by_core<compact_correction>)->Name("points_compact")->Apply(sizes);
BENCHMARK_CAPTURE(points_in_bulk, g4, g4_model)->Apply(sizes);
BENCHMARK_CAPTURE(points_in_bulk, x4, *model_named("x4"))->Arg(cache_points);
BENCHMARK_CAPTURE(points_in_bulk, g6, *model_named("g6"))->Arg(cache_points);
BENCHMARK_CAPTURE(points_in_bulk, tg30, *model_named("tg30"))->Arg(cache_points);
BENCHMARK_CAPTURE(points_in_bulk, g2, *model_named("g2"))->Arg(cache_points);
BENCHMARK_CAPTURE(points_in_bulk, s4b, *model_named("s4b"))->Arg(cache_points);
BENCHMARK_CAPTURE(points_in_bulk, scl, *model_named("scl"))->Arg(cache_points);
BENCHMARK_CAPTURE(points_in_bulk, t_mini, *model_named("t-mini"))->Arg(cache_points);
BENCHMARK_CAPTURE(points_in_bulk, t_mini_plus_sh, *model_named("t-mini-plus-sh"))
    ->Arg(cache_points);
BENCHMARK(places_in_bulk)->Apply(sizes);
BENCHMARK(deskew_twist)->Apply(sizes);
BENCHMARK(deskew_path)->Apply(sizes);

}  // namespace
