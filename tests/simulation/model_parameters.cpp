// SPDX-License-Identifier: MIT
// What was drawn for a G4 becomes what another model can be.
#include <algorithm>
#include <string_view>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "parameters.hpp"

namespace g4lidar::simulation {
namespace {

/// The rates of bridges are near the one that was asked for: a CP2102 makes 500000 of 512000, a CP2102N
/// 127659 of 128000.
std::uint32_t some_bridge_baud(dice& d, std::uint32_t baud) {
  if (baud == 512'000 && d.chance(0.5)) return 500'000;
  return d.chance(0.5) ? 0 : static_cast<std::uint32_t>(baud * d.real(0.985, 1.015));
}

/// What healthy devices of one model may differ in beside their packets.
void draw_additions(dice& d, sim::device_options& device) {
  device.ct_information = d.chance(0.5);
  if (device.ct_information) device.scanner.ordinary_ct = 0;
  // Nothing, a random byte or a CRC.
  const auto leading = d.between(0, 2);
  device.stray_before_zero = leading > 0;
  device.stray_after_start = leading == 1;
  device.ct_crc = leading == 2;
  device.time_packet_ns = d.chance(0.5) ? d.between(50 * ms, second) : 0;
  device.empty_packets = d.chance(0.3);
  device.scanner.index_deg = d.chance(0.5) ? device.scanner.index_deg : d.real(0.0, 359.9);
}

/// What owners have seen: an X2 and its like with other rates, an S2 that answers and has another rate.
void draw_oddities(dice& d, std::string_view word, sim::device_options& device) {
  if ((word == "x2" || word == "x2l" || word == "x3") && d.chance(0.5)) {
    const auto rate_hz = static_cast<std::uint32_t>(d.between(2500, 3600));
    device.scanner.format.rates_hz = {rate_hz, 0, 0};
    device.scanner.sample_rate = static_cast<sample_rate>(rate_hz);
    device.scanner.scan_frequency_chz = static_cast<std::uint16_t>(d.between(500, 1010));
  }
  if (word == "s4b" && d.chance(0.5)) {
    device.baud = 150'000;
    device.info.model = 12;
  }
}

/// A number that no model has, or that of a model whose samples have another size: the user has named the right one.
void draw_number(dice& d, sim::device_options& device) {
  const std::size_t size = sample_size(model_named(device.model)->samples.layout);
  std::vector<std::uint8_t> numbers{99, 153, 250};
  for (const model& other : models) {
    const auto is_alike = [&](const model& row) {
      const bool has_it = std::ranges::find(row.ids, other.ids[0]) != row.ids.end();
      return has_it && sample_size(row.samples.layout) == size;
    };
    if (std::ranges::none_of(models, is_alike)) numbers.push_back(other.ids[0]);
  }
  const auto last = static_cast<std::int64_t>(numbers.size()) - 1;
  const auto drawn = static_cast<std::size_t>(d.between(0, last));
  if (d.chance(0.4)) device.info.model = numbers[drawn];
}

/// Answers to D1 and 93. Without its answer the direction of zero is not known, so it is 0 where one may be lost.
void draw_answers(dice& d, run_parameters& parameters) {
  sim::device_options& device = parameters.device;
  const model& which = *model_named(device.model);
  if (which.zero_angle_divisor != 0) {
    if (d.chance(0.3)) device.zero_angle_divisor = 0;
    const bool is_known = device.zero_angle_divisor != 0 && parameters.healthy;
    // In quarters of a degree, so that every divisor can state it.
    if (is_known) device.zero_angle_cdeg = static_cast<std::int32_t>(25 * d.between(-700, 700));
  }
  if (which.rates.is_settable && d.chance(0.3)) device.answers_sample_rate = false;
  parameters.unanswered =
      (which.zero_angle_divisor != 0 && device.zero_angle_divisor == 0 ? 1 : 0) +
      (which.rates.is_settable && !device.answers_sample_rate ? 1 : 0);
}

}  // namespace

bool has_other_number(const run_parameters& parameters) {
  const auto& own = model_named(parameters.device.model)->ids;
  return std::ranges::find(own, parameters.device.info.model) == own.end();
}

bool is_usual(const run_parameters& parameters, lidar_event::kind what) {
  using kind = lidar_event::kind;
  // A one-way lidar goes on when it was stopped.
  if (what == kind::still_turning) return parameters.device.one_way;
  if (what == kind::other_number) return has_other_number(parameters);
  return what == kind::spinning_up;
}

void become(dice& d, std::string_view word, run_parameters& parameters) {
  sim::device_options& v = parameters.device;
  static_cast<void>(sim::use_model(v, word));
  v.scanner.samples_per_packet = v.scanner.format.max_samples == max_samples ? 80 : 40;
  v.scanner.sample_rate_ratio = d.real(0.97, 1.0);  // an S2 has no room for more
  v.initial = {};
  if (d.chance(0.5)) v.while_scanning = sim::disturbance::between;
  if (!v.one_way) v.dtr_starts_by = static_cast<sim::dtr_start>(d.between(0, 2));
  if (v.one_way) v.error_refuses_start = false;  // nobody would start it again
  // A device that answers has its supply from the USB bridge.
  if (v.one_way) v.dtr_cuts = d.chance(0.5) ? sim::dtr_cut::motor : sim::dtr_cut::supply;
  v.dtr_low_ns = d.between(0, 90 * ms);
  lidar_options& o = parameters.options;
  o.model = model_named(word);
  o.sample_rate.reset();
  o.frequency.reset();
  o.direction.reset();
  o.constant.reset();
  o.idle.reset();
  o.protection.reset();
  if (v.commands.has(0x0B) && d.chance(0.4)) {
    const sim::wire_format& format = v.scanner.format;
    o.frequency = scan_frequency{static_cast<std::uint16_t>(
        d.between(format.min_frequency_chz / 10, format.max_frequency_chz / 10) * 10)};
  }
  draw_additions(d, v);
  draw_answers(d, parameters);
  draw_oddities(d, word, v);
  if (!v.one_way) draw_number(d, v);
  parameters.bridge_baud = some_bridge_baud(d, v.baud);
}

}  // namespace g4lidar::simulation
