// SPDX-License-Identifier: MIT
// The bulk decoder: from the parser to the kernels, and the selection of the kernels.
#include "g4lidar/recording/bulk_decoder.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>
#include <type_traits>
#include <variant>

#include "bulk_kernel.hpp"

namespace g4lidar {

namespace bulk {

namespace {

constexpr bool has_kernels(sample_layout layout, correction_kind correction) noexcept {
  return find_kernels<vector_kernels>({layout, correction}) != nullptr;
}
static_assert(std::ranges::all_of(models, [](const model& each) {
  const correction_kind correction = each.samples.correction;
  return has_kernels(each.samples.layout, correction) &&
         has_kernels(each.other_layout, correction) &&
         (each.old_firmware.last_version == 0 || has_kernels(each.old_firmware.layout, correction));
}));

}  // namespace

const kernels& kernels_of(instruction_set set, sample_format format) noexcept {
#if G4LIDAR_HAS_AVX2_KERNELS
  if (set == instruction_set::avx2) return avx2_kernels_of(format);
#endif
  static_cast<void>(set);
  const kernels* const found = find_kernels<vector_kernels>(format);
  assert(found != nullptr);
  return *found;
}

}  // namespace bulk

instruction_set best_instruction_set() noexcept {
#if G4LIDAR_HAS_AVX2_KERNELS
  if (__builtin_cpu_supports("avx2")) return instruction_set::avx2;
#endif
  return instruction_set::portable;
}

const char* name_of(instruction_set set) noexcept {
  return set == instruction_set::avx2 ? "AVX2" : "portable";
}

bulk_decoder::bulk_decoder(instruction_set wanted) noexcept : bulk_decoder(g4_model, wanted) {}

bulk_decoder::bulk_decoder(const model& model, instruction_set wanted) noexcept
    : parser_(model.samples),
      named_(&model),
      which_(&model),
      set_(wanted == best_instruction_set() ? wanted : instruction_set::portable) {}

void bulk_decoder::learn(const response_view& heard) noexcept {
  const auto stated = replies_.take(heard, *which_);
  if (stated.zero) zero_.set(*stated.zero, zero_offset::stated_by::device);
  if (!stated.firmware) return;
  which_ = &with_firmware(*named_, *stated.firmware);
  parser_.set_layout(which_->samples.layout);
}

/// The next event, and how many points were written for it.
template <class Source, class Point, class Convert>
std::optional<std::size_t> bulk_decoder::step(const Source& source, const Convert& convert,
                                              std::span<Point, max_samples> out) noexcept {
  const std::optional<event> found = source.next(parser_);
  if (!found) return std::nullopt;
  counts_.add(*found);
  if (const auto* const heard = std::get_if<response_view>(&*found)) {
    learn(*heard);
    return 0;
  }
  replies_.pass();
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

/// The kernels for the packets of a model, also where a device information between them states old firmware.
class kernel_choice {
 public:
  kernel_choice(instruction_set set, const model& model) noexcept
      : set_(set), format_(model.samples), usual_(&bulk::kernels_of(set, model.samples)) {}

  [[nodiscard]] const bulk::kernels& of(packet_view packet) const noexcept {
    if (packet.layout() == format_.layout) return *usual_;
    return bulk::kernels_of(set_, {packet.layout(), format_.correction});
  }

 private:
  instruction_set set_;
  sample_format format_;
  const bulk::kernels* usual_;
};

/// Turns positions in frame `to` by the angle that is added to those of the device, which count clockwise.
void turn(std::span<xy_point> points, frame to, const zero_offset& zero) noexcept {
  if (!zero.angle() || zero.angle()->cdeg == 0) return;
  const double sign = to == frame::vendor ? 1.0 : -1.0;
  const double turn_rad = sign * zero.angle()->deg() * std::numbers::pi / 180.0;
  const auto cosine = static_cast<float>(std::cos(turn_rad));
  const auto sine = static_cast<float>(std::sin(turn_rad));
  for (xy_point& each : points) {
    const float x_m = each.x_m;
    each.x_m = cosine * x_m - sine * each.y_m;
    each.y_m = sine * x_m + cosine * each.y_m;
  }
}

auto points_with(instruction_set set, const model& model, const zero_offset& zero) noexcept {
  return [choice = kernel_choice(set, model), shortest_mm = model.range.min_mm, &zero](
             packet_view packet, std::uint32_t revolution,
             std::span<point, max_samples> out) noexcept {
    choice.of(packet).to_points(packet, revolution, shortest_mm, {}, out);
    zero.add_to(out.first(packet.sample_count()));
  };
}

auto places_with(instruction_set set, const model& model, const zero_offset& zero,
                 frame to) noexcept {
  return [choice = kernel_choice(set, model), &zero, to, turn_deg = model.turn_deg](
             packet_view packet, std::uint32_t /*revolution*/,
             std::span<xy_point, max_samples> out) noexcept {
    choice.of(packet).to_xy(packet, to, turn_deg, out);
    turn(out.first(packet.sample_count()), to, zero);
  };
}

}  // namespace

std::span<point> bulk_decoder::decode(bytes& input, std::span<point> out) noexcept {
  return run(going_on{input}, points_with(set_, *which_, zero_), out);
}

std::span<xy_point> bulk_decoder::decode_xy(bytes& input, frame to,
                                            std::span<xy_point> out) noexcept {
  return run(going_on{input}, places_with(set_, *which_, zero_, to), out);
}

std::span<point> bulk_decoder::finish(std::span<point> out) noexcept {
  return run(ended{}, points_with(set_, *which_, zero_), out);
}

std::span<xy_point> bulk_decoder::finish_xy(frame to, std::span<xy_point> out) noexcept {
  return run(ended{}, places_with(set_, *which_, zero_, to), out);
}

}  // namespace g4lidar
