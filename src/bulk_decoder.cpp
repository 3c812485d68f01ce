// SPDX-License-Identifier: MIT
// The bulk decoder: the way from the parser to the kernels, and the choice of the kernels.
#include "g4lidar/bulk_decoder.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <variant>

#include "bulk_kernels.hpp"
#include "g4lidar/correction.hpp"

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

}  // namespace

const kernels portable_kernels{portable_to_points, portable_to_xy};

}  // namespace bulk

namespace {

const bulk::kernels& kernels_of(instruction_set set) noexcept {
#if G4LIDAR_HAS_AVX2_KERNELS
  if (set == instruction_set::avx2) return bulk::avx2_kernels;
#endif
  static_cast<void>(set);
  return bulk::portable_kernels;
}

/// Converts into `out`, by way of a packet's worth of scratch memory where a kernel could write
/// behind its end.
template <class Point, class Kernel>
void convert_to_front(std::span<Point> out, std::size_t count, const Kernel& kernel) noexcept {
  if (out.size() >= max_samples) return kernel(out.template first<max_samples>());
  std::array<Point, max_samples> scratch;
  kernel(std::span<Point, max_samples>(scratch));
  std::copy_n(scratch.begin(), count, out.begin());
}

}  // namespace

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

/// Converts packet after packet as `next` finds them. Where a packet is found to have no room, the
/// step is taken back: `next` takes a parser and gives an event, and touches nothing else that
/// `undo` does not restore.
template <class Next, class Point, class Convert>
std::span<Point> bulk_decoder::run(const Next& next, std::span<Point> out,
                                   const Convert& convert) noexcept {
  std::size_t used = 0;
  while (true) {
    const std::span<Point> room = out.subspan(used);
    // A packet that may not fit is looked for with a copy of the parser first.
    std::optional<stream_parser> before;
    if (room.size() < max_samples) before = parser_;
    const auto mark = next.mark();
    const std::optional<event> found = next(parser_);
    if (!found) break;
    const auto* const packet = std::get_if<packet_view>(&*found);
    if (packet != nullptr && !packet->is_suspect()) {
      const std::size_t count = packet->sample_count();
      if (count > room.size()) {
        parser_ = *before;
        next.go_back(mark);
        break;
      }
      counts_.add(*packet);
      convert(*packet, revolutions_.count(*packet), room);
      used += count;
      continue;
    }
    if (packet != nullptr) static_cast<void>(revolutions_.count(*packet));
    counts_.add(*found);
  }
  return out.first(used);
}

namespace {

/// Events from an input that goes on, and from one that has ended.
struct from_input {
  bytes& input;

  std::optional<event> operator()(stream_parser& parser) const noexcept {
    return parser.next(input);
  }
  [[nodiscard]] bytes mark() const noexcept { return input; }
  void go_back(bytes to) const noexcept { input = to; }
};
struct from_end {
  std::optional<event> operator()(stream_parser& parser) const noexcept { return parser.finish(); }
  [[nodiscard]] int mark() const noexcept { return 0; }
  void go_back(int /*to*/) const noexcept {}
};

auto point_converter(instruction_set set) noexcept {
  return [kernel = kernels_of(set).to_points](packet_view packet, std::uint32_t revolution,
                                              std::span<point> out) noexcept {
    convert_to_front(out, packet.sample_count(), [&](std::span<point, max_samples> to) noexcept {
      kernel(packet, revolution, to);
    });
  };
}

auto xy_converter(instruction_set set, frame frame_of) noexcept {
  return [kernel = kernels_of(set).to_xy, frame_of](packet_view packet, std::uint32_t,
                                                    std::span<xy_point> out) noexcept {
    convert_to_front(out, packet.sample_count(), [&](std::span<xy_point, max_samples> to) noexcept {
      kernel(packet, frame_of, to);
    });
  };
}

}  // namespace

std::span<point> bulk_decoder::decode(bytes& input, std::span<point> out) noexcept {
  return run(from_input{input}, out, point_converter(set_));
}

std::span<xy_point> bulk_decoder::decode_xy(bytes& input, frame to,
                                            std::span<xy_point> out) noexcept {
  return run(from_input{input}, out, xy_converter(set_, to));
}

std::span<point> bulk_decoder::finish(std::span<point> out) noexcept {
  return run(from_end{}, out, point_converter(set_));
}

std::span<xy_point> bulk_decoder::finish_xy(frame to, std::span<xy_point> out) noexcept {
  return run(from_end{}, out, xy_converter(set_, to));
}

}  // namespace g4lidar
