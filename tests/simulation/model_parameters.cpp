// SPDX-License-Identifier: MIT
// What was drawn for a G4 becomes what another model can be.
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/packet.hpp"
#include "parameters.hpp"

namespace g4lidar::simulation {

void become(dice& d, std::string_view word, run_parameters& parameters) {
  sim::device_options& v = parameters.device;
  static_cast<void>(sim::use_model(v, word));
  v.scanner.samples_per_packet = v.scanner.format.max_samples == max_samples ? 80 : 40;
  v.scanner.sample_rate_ratio = d.real(0.97, 1.0);  // an S2 has no room for more
  if (v.ct_information) v.scanner.ordinary_ct = 0;
  v.initial = {};
  if (d.chance(0.5)) v.while_scanning = sim::disturbance::between;
  if (!v.one_way) v.dtr_starts_by = static_cast<sim::dtr_start>(d.between(0, 2));
  if (v.one_way) v.error_refuses_start = false;  // nobody would start it again
  // A device that answers has its supply from the USB bridge.
  if (v.one_way) v.dtr_cuts = d.chance(0.5) ? sim::dtr_cut::motor : sim::dtr_cut::supply;
  v.dtr_low_ns = d.between(0, 90 * ms);
  if (d.chance(0.3)) v.time_packet_ns = d.between(50 * ms, second);
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
}

}  // namespace g4lidar::simulation
