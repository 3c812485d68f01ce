// SPDX-License-Identifier: MIT
// The bulk decoder: from the parser to the kernels, and the selection of the kernels.
#include "g4lidar/bulk_decoder.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <variant>

#include "bulk_kernels.hpp"
#include "g4lidar/core/correction.hpp"

namespace g4lidar {

namespace bulk {

namespace {

void portable_to_points(packet_view packet, std::uint32_t revolution,
                        std::span<point, max_samples> out) noexcept {
  static_cast<void>(g4lidar::decode(packet, compact_correction{}, revolution, out));
}

void portable_to_xy(packet_view packet, frame to, std::span<xy_point, max_samples> out) noexcept {
  std::array<point, max_samples> points;
  portable_to_points(packet, 0, points);
  to_xy(std::span(points).first(packet.sample_count()), to, out);
}

void portable_to_timed_points(packet_view packet, std::uint32_t revolution,
                              const packet_times& times,
                              std::span<point, max_samples> out) noexcept {
  portable_to_points(packet, revolution, out);
  times.write_to(out.first(packet.sample_count()));
}

}  // namespace

const kernels portable_kernels{portable_to_points, portable_to_timed_points, portable_to_xy};

const kernels& kernels_of(instruction_set set) noexcept {
#if G4LIDAR_HAS_AVX2_KERNELS
  if (set == instruction_set::avx2) return avx2_kernels;
#endif
  static_cast<void>(set);
  return portable_kernels;
}

}  // namespace bulk

instruction_set best_instruction_set() noexcept {
#if G4LIDAR_HAS_AVX2_KERNELS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return instruction_set::avx2;
#endif
  return instruction_set::portable;
}

const char* name_of(instruction_set set) noexcept {
  return set == instruction_set::avx2 ? "AVX2" : "portable";
}

bulk_decoder::bulk_decoder(instruction_set wanted) noexcept
    : set_(wanted == best_instruction_set() ? wanted : instruction_set::portable) {}

/// The next event, and how many points were written for it.
template <class Source, class Point, class Convert>
std::optional<std::size_t> bulk_decoder::step(const Source& source, const Convert& convert,
                                              std::span<Point, max_samples> out) noexcept {
  const std::optional<event> found = source.next(parser_);
  if (!found) return std::nullopt;
  counts_.add(*found);
  const auto* const packet = std::get_if<packet_view>(&*found);
  if (packet == nullptr) return 0;
  const std::uint32_t revolution = revolutions_.count(*packet);
  if (packet->is_suspect()) return 0;
  convert(*packet, revolution, out);
  return packet->sample_count();
}

template <class Source, class Point, class Convert>
std::span<Point> bulk_decoder::run(const Source& source, const Convert& convert,
                                   std::span<Point> out) noexcept {
  std::size_t used = 0;
  while (out.size() - used >= max_samples) {
    const auto count = step(source, convert, out.subspan(used).template first<max_samples>());
    if (!count) return out.first(used);
    used += *count;
  }
  // Now the next packet may not fit. Each step is tried, and undone in that case.
  while (true) {
    const bulk_decoder before = *this;
    const auto place = source.place();
    std::array<Point, max_samples> points;
    const auto count = step(source, convert, std::span(points));
    if (!count) break;
    if (*count > out.size() - used) {
      *this = before;
      source.go_back(place);
      break;
    }
    std::copy_n(points.begin(), *count, out.subspan(used).begin());
    used += *count;
  }
  return out.first(used);
}

namespace {

/// Events of an input that continues.
struct going_on {
  bytes& input;

  [[nodiscard]] std::optional<event> next(stream_parser& parser) const noexcept {
    return parser.next(input);
  }
  [[nodiscard]] bytes place() const noexcept { return input; }
  void go_back(bytes to) const noexcept { input = to; }
};

/// Events of an input that has ended; the rest of it is in the parser.
struct ended {
  [[nodiscard]] std::optional<event> next(stream_parser& parser) const noexcept {
    return parser.finish();
  }
  [[nodiscard]] bytes place() const noexcept { return {}; }
  void go_back(bytes /*to*/) const noexcept {}
};

auto points_with(instruction_set set) noexcept { return bulk::kernels_of(set).to_points; }

auto places_with(instruction_set set, frame to) noexcept {
  return [kernel = bulk::kernels_of(set).to_xy, to](
             packet_view packet, std::uint32_t /*revolution*/,
             std::span<xy_point, max_samples> out) noexcept { kernel(packet, to, out); };
}

}  // namespace

std::span<point> bulk_decoder::decode(bytes& input, std::span<point> out) noexcept {
  return run(going_on{input}, points_with(set_), out);
}

std::span<xy_point> bulk_decoder::decode_xy(bytes& input, frame to,
                                            std::span<xy_point> out) noexcept {
  return run(going_on{input}, places_with(set_, to), out);
}

std::span<point> bulk_decoder::finish(std::span<point> out) noexcept {
  return run(ended{}, points_with(set_), out);
}

std::span<xy_point> bulk_decoder::finish_xy(frame to, std::span<xy_point> out) noexcept {
  return run(ended{}, places_with(set_, to), out);
}

}  // namespace g4lidar
