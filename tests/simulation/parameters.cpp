// SPDX-License-Identifier: MIT
#include "parameters.hpp"

#include <algorithm>
#include <cmath>

#include "g4lidar/core/response.hpp"
#include "g4lidar/core/session_times.hpp"
#include "text.hpp"

namespace g4lidar::simulation {
namespace {

using std::chrono::milliseconds;

/// From opening to the scan: questions, 7 steps of 1 Hz and 10 of 0.1 Hz, and as many readings; and the
/// settings once more where an answer was lost.
constexpr int most_commands = 50;

template <class Enum>
Enum either(dice& d, Enum a, Enum b, double p = 0.5) {
  return d.chance(p) ? a : b;
}

sample_rate some_rate(dice& d) {
  return *reply_byte<sample_rate>(static_cast<std::uint8_t>(d.between(0, 2)));
}

void draw_scanner(dice& d, std::uint64_t seed, sim::scanner_options& scanner) {
  scanner.seed = seed;
  scanner.scan_frequency_chz = static_cast<std::uint16_t>(d.between(500, 1200));
  scanner.sample_rate = d.chance(0.6) ? sample_rate::khz_9 : some_rate(d);
  // More exceeds the baud rate: 9.3 kHz with a header for each 30 samples are 21.6 kB/s.
  scanner.samples_per_packet = static_cast<std::size_t>(d.chance(0.5) ? 40 : d.between(30, 80));
  scanner.index_deg = d.chance(0.5) ? 0.0 : d.real(0.0, 359.9);
  scanner.reports_frequency = d.chance(0.5);
  // Noise makes samples differ from those of other turns.
  scanner.noise_mm = d.real(5.0, 20.0);
  scanner.dropout_ratio = d.chance(0.3) ? d.real(0.0, 0.05) : 0.0;
  scanner.sample_rate_ratio = d.chance(0.3) ? 1.0 : d.real(0.97, 1.03);
  scanner.sample_rate_drift_ppm = d.real(0.0, 200.0);
  scanner.ordinary_ct = d.chance(0.5) ? std::uint8_t{0} : std::uint8_t{0x86};
}

void draw_motor(dice& d, sim::device_options& device) {
  device.acceleration_mhz_per_s = static_cast<std::uint32_t>(d.between(7'000, 28'000));
  device.motor_drift_ppm = static_cast<std::uint32_t>(d.between(0, 4'000));
  device.free_motor_drift_ppm = static_cast<std::uint32_t>(d.between(4'000, 40'000));
  device.motor_drift_period_ns = d.between(5 * second, 60 * second);
}

/// Half of the devices are as quick as can be; for the others each time is drawn over a factor of ten.
void draw_times(dice& d, sim::device_options& device) {
  const auto tenfold = [&d](std::int64_t least_ns) {
    const auto least = static_cast<double>(least_ns);
    return static_cast<std::int64_t>(d.spread(least, 10 * least));
  };
  device.reaction_ns = tenfold(5 * ms);
  device.boot_ns = tenfold(100 * ms);
  device.first_answer_ns = d.chance(0.5) ? 0 : tenfold(85 * ms);
  device.header_ns = d.chance(0.5) ? 0 : tenfold(180 * ms);
  device.silence_ns = d.chance(0.5) ? 0 : tenfold(250 * ms);
  device.standstill_ns = tenfold(20 * ms);
  device.stop_ns = d.chance(0.5) ? 0 : tenfold(40 * ms);
}

void draw_questions(dice& d, sim::device_options& device) {
  device.stray_after_start = d.chance(0.5);
  device.stray_before_zero = d.chance(0.6);
  device.ct_crc = device.stray_after_start;  // no further draw, so that seeds keep their meaning
  device.stop_truncates = d.chance(0.5);
  device.boot_text = d.chance(0.5);
  device.boot_information = d.chance(0.5);
  device.frequency_at_limit = either(d, sim::at_limit::clamp, sim::at_limit::refuse);
  device.while_scanning = static_cast<sim::disturbance>(d.between(0, 3));
  device.settings_outlive_power = d.chance(0.5);
  device.settings_outlive_restart = d.chance(0.5);
  device.answers_direction = d.chance(0.7);
  device.answers_health_91 = d.chance(0.7);
  device.answers_health_92 = !device.answers_health_91 || d.chance(0.7);
  device.obeys_forced_stop = d.chance(0.5);
  device.obeys_restart_80 = d.chance(0.7);
  device.obeys_restart_40 = !device.obeys_restart_80 || d.chance(0.5);
  device.error_refuses_start = d.chance(0.5);
  device.start_again_answers = d.chance(0.3);
  device.header_after_protection = d.chance(0.5);
}

void draw_memory(dice& d, bool healthy, sim::device_settings& initial) {
  initial.idle_power = either(d, low_power::off, low_power::on, 0.2);
  initial.direction =
      either(d, motor_direction::counter_clockwise, motor_direction::clockwise, 0.2);
  initial.constancy = either(d, constant_frequency::off, constant_frequency::on, 0.2);
  // A protection of which nobody knows is found by the end of a scan: not in a healthy run.
  if (!healthy && d.chance(0.1)) initial.protection = power_down_protection::on;
}

void draw_device(dice& d, run_parameters& parameters) {
  draw_scanner(d, parameters.seed, parameters.device.scanner);
  draw_motor(d, parameters.device);
  draw_times(d, parameters.device);
  draw_questions(d, parameters.device);
  // Such a header would stand in the middle of a packet.
  if (parameters.healthy) parameters.device.start_again_answers = false;
  draw_memory(d, parameters.healthy, parameters.device.initial);
  parameters.device.batch_min_ns = d.chance(0.7) ? 0 : d.between(0, 2 * ms);
  const std::int64_t most = d.chance(0.5) ? ms : 16 * ms;
  parameters.device.batch_max_ns = parameters.device.batch_min_ns + d.between(0, most);
  parameters.device.boots_at_start = !parameters.healthy && d.chance(0.15);
  // The truth is taken at each call of the driver, whose longest wait, for a first packet that a stall holds
  // back, is 10 s: 93,000 samples.
  parameters.device.truth_capacity = 100'000;
}

void draw_options(dice& d, run_parameters& parameters) {
  lidar_options& o = parameters.options;
  if (d.chance(0.4)) o.sample_rate = some_rate(d);
  if (d.chance(0.4))
    o.frequency = scan_frequency{static_cast<std::uint16_t>(d.between(50, 120) * 10)};
  if (d.chance(0.2)) o.direction = static_cast<motor_direction>(d.between(0, 1));
  if (d.chance(0.2)) o.constant = either(d, constant_frequency::on, constant_frequency::off);
  if (d.chance(0.2)) o.idle = either(d, low_power::on, low_power::off);
  if (d.chance(0.4)) {
    o.protection = either(d, power_down_protection::on, power_down_protection::off, 0.8);
  }
  o.reconnect = d.chance(0.85);
  if (d.chance(0.5)) o.tuning.longest_backoff = milliseconds(d.between(1, 1000));
  if (d.chance(0.2)) o.tuning.answer_time = milliseconds(d.between(100, 600));
  if (d.chance(0.3)) o.tuning.stall_time = milliseconds(d.between(300, 2000));
  if (d.chance(0.3)) o.tuning.batch = milliseconds(d.between(1, 40));
  o.partial_scans = d.chance(0.3);
  o.tuning.pace = either(d, read_pace::packets, read_pace::revolutions);
}

void draw_application(dice& d, run_parameters& parameters) {
  application_behavior& m = parameters.application;
  const auto style = d.between(0, 3);
  m.scans = style == 0 || style == 3 ? 1.0 : 0.05;
  m.points = style == 1 || style == 3 ? 1.0 : 0.05;
  m.process = style >= 2 ? 1.0 : 0.05;
  m.wake = d.chance(0.5) ? 0.05 : 0.0;
  m.ask = d.chance(0.5) ? 0.01 : 0.0;
  m.stop = d.chance(0.3) ? 0.01 : 0.0;
  m.reopen = d.chance(0.2) ? 0.005 : 0.0;
  m.move = 0.01;
  m.sleep = d.chance(0.4) ? 0.01 : 0.0;
  // Within 3 s neither the 64 KiB of the host nor the patience of the protection are at their end.
  m.longest_sleep_ns = parameters.healthy ? 1'500 * ms : 5 * second;
}

std::int64_t some_duration(dice& d, std::int64_t most_ns) {
  return std::min(most_ns, static_cast<std::int64_t>(d.spread(5e6, 6e9)));
}

sim::fault draw_fault(dice& d, std::int64_t until_ns) {
  using sim::fault_kind;
  const auto kind = static_cast<fault_kind>(d.between(0, static_cast<int>(sim::last_fault_kind)));
  const std::int64_t begin_ns = d.chance(0.1) ? 0 : d.between(std::int64_t{0}, until_ns - 10 * ms);
  sim::fault f = sim::make_fault(kind, begin_ns, some_duration(d, until_ns - begin_ns));
  switch (kind) {
    case fault_kind::flip:
    case fault_kind::drop:
    case fault_kind::insert:
      f.rate = d.spread(1e-5, 2e-2);
      break;
    case fault_kind::burst:
      f.rate = d.spread(1e-5, 1e-3);
      f.amount = d.between(1, 300);
      break;
    case fault_kind::truncate:
    case fault_kind::jolt:
    case fault_kind::omit:
      f.rate = d.spread(1e-3, 0.5);
      break;
    case fault_kind::batch:
      f.amount = d.between(1 * ms, 60 * ms);
      break;
    case fault_kind::late:
      f.amount = static_cast<std::int64_t>(d.spread(1e6, 2e9));
      f.rate = d.real(0.1, 1.0);
      break;
    case fault_kind::wrong:
    case fault_kind::twice:
    case fault_kind::mute:
      f.rate = d.chance(0.5) ? 1.0 : d.real(0.1, 1.0);
      break;
    case fault_kind::brown_out:
    case fault_kind::reboot:
      f.amount = d.between(0, 200 * ms);
      break;
    case fault_kind::health:
      f.amount = d.between(1, 2);
      break;
    default:
      break;
  }
  return f;
}

/// When nothing of a fault is at work any more.
std::int64_t end_of(const sim::fault& f) {
  const std::int64_t end_ns = f.begin_ns + f.duration_ns;
  return f.kind == sim::fault_kind::late ? end_ns + f.amount : end_ns;
}

void draw_faults(dice& d, run_parameters& parameters) {
  const std::int64_t until_ns = d.between(4 * second, 30 * second);
  parameters.calm_ns = 0;
  for (std::int64_t left = d.between(1, 8); left > 0; --left) {
    parameters.faults.push_back(draw_fault(d, until_ns));
    parameters.calm_ns = std::max(parameters.calm_ns, end_of(parameters.faults.back()));
  }
}

std::uint32_t slowest_chz(const run_parameters& parameters) {
  const std::uint32_t own = parameters.device.scanner.scan_frequency_chz;
  return parameters.options.frequency
             ? std::min<std::uint32_t>(own, parameters.options.frequency->chz)
             : own;
}

/// To 12 Hz.
std::int64_t spin_up_ns(const sim::device_options& device) {
  return device.standstill_ns + 12'000 * second / device.acceleration_mhz_per_s;
}

}  // namespace

double dice::spread(double least, double most) {
  return std::exp(real(std::log(least), std::log(most)));
}

run_parameters draw_run(std::uint64_t seed, std::string_view model) {
  dice d(seed, 0x11FE);
  run_parameters parameters;
  parameters.seed = seed;
  parameters.healthy = d.chance(0.2);
  draw_device(d, parameters);
  draw_options(d, parameters);
  draw_application(d, parameters);
  if (parameters.healthy) {
    parameters.calm_ns = d.between(10 * second, 40 * second);
  } else {
    draw_faults(d, parameters);
  }
  if (!model.empty()) {
    dice of_model(seed, 0x30DE1);
    become(of_model, model, parameters);
  }
  parameters.end_ns =
      parameters.calm_ns + recovery_time_ns(parameters) + d.between(4 * second, 10 * second);
  return parameters;
}

std::int64_t own_time_ns(const run_parameters& parameters) {
  const std::int64_t turns_ns = 2 * 100 * second / slowest_chz(parameters);
  const sim::device_options& v = parameters.device;
  // What has no answer is asked three times.
  const std::int64_t unanswered_ns =
      3 * parameters.unanswered *
      std::chrono::nanoseconds(parameters.options.tuning.answer_time).count();
  return v.stop_ns + v.boot_ns + v.first_answer_ns + most_commands * v.reaction_ns + v.header_ns +
         std::max(v.silence_ns, spin_up_ns(v)) + turns_ns + unanswered_ns;
}

std::int64_t recovery_time_ns(const run_parameters& parameters) {
  const auto beyond = [](milliseconds time, milliseconds by_default) {
    return std::max<std::int64_t>(0, std::chrono::nanoseconds(time - by_default).count());
  };
  const lidar_options defaults;
  // A device that dies between its scan header and its first packet looks like one that spins up.
  const bool may_die = std::ranges::any_of(parameters.faults, [](const sim::fault& f) {
    return f.kind == sim::fault_kind::brown_out || f.kind == sim::fault_kind::reboot ||
           f.kind == sim::fault_kind::baud;
  });
  const session_times times;
  const std::int64_t died_ns = may_die ? times.first_packet_ns + own_time_ns(parameters) : 0;
  // A start whose header was lost is sent again when start_ns has passed without a packet.
  const sim::device_options& v = parameters.device;
  const bool is_late = v.header_ns + v.silence_ns + v.standstill_ns > times.start_ns - second;
  const std::int64_t lost_ns = is_late ? times.start_ns + times.drain_ns : 0;
  // Of an unknown protection is learned by the end of a scan, or, where it stops the device before its
  // first packet, by their absence.
  const std::int64_t until_packet_ns = v.header_ns + std::max(v.silence_ns, spin_up_ns(v));
  const std::int64_t learned_ns = until_packet_ns < times.protected_ns
                                      ? times.protected_ns + times.stall_ns
                                      : times.first_packet_ns;
  const bool is_protected = v.initial.protection == power_down_protection::on &&
                            parameters.options.protection != power_down_protection::on;
  const std::int64_t starved_ns = is_protected ? learned_ns + own_time_ns(parameters) : 0;
  return died_ns + lost_ns + starved_ns + own_time_ns(parameters) + 2 * second +
         beyond(parameters.options.tuning.stall_time, defaults.tuning.stall_time) +
         3 * beyond(parameters.options.tuning.answer_time, defaults.tuning.answer_time);
}

std::string describe(const run_parameters& parameters) {
  std::string text = text_of("%s with seed %llu: calm from %.3f s, over at %.3f s\n",
                             parameters.healthy ? "a healthy run" : "a run",
                             static_cast<unsigned long long>(parameters.seed),
                             in_seconds(parameters.calm_ns), in_seconds(parameters.end_ns));
  for (const sim::fault& f : parameters.faults) {
    text += text_of("  fault %s=%lld*%g@%.6fs+%.6fs\n", name_of(f.kind).data(),
                    static_cast<long long>(f.amount), f.rate, in_seconds(f.begin_ns),
                    in_seconds(f.duration_ns));
  }
  const lidar_options& o = parameters.options;
  text += text_of(
      "  reconnect %d, backoff %d ms, answer %d ms, stall %d ms, batch %d ms, pace %d, protection "
      "%d\n",
      int{o.reconnect}, static_cast<int>(o.tuning.longest_backoff.count()),
      static_cast<int>(o.tuning.answer_time.count()), static_cast<int>(o.tuning.stall_time.count()),
      static_cast<int>(o.tuning.batch.count()), static_cast<int>(o.tuning.pace),
      o.protection ? static_cast<int>(*o.protection) : -1);
  const sim::device_options& v = parameters.device;
  text += text_of(
      "  device at %u cHz, %zu samples a packet, rate %.4f, batch %.1f to %.1f ms\n"
      "  times in ms: boot %.0f, first answer %.0f, answer %.0f, header %.0f, silence %.0f, "
      "standstill %.0f, stop %.0f\n",
      unsigned{v.scanner.scan_frequency_chz}, v.scanner.samples_per_packet,
      v.scanner.sample_rate_ratio, in_seconds(v.batch_min_ns) * 1e3,
      in_seconds(v.batch_max_ns) * 1e3, in_seconds(v.boot_ns) * 1e3,
      in_seconds(v.first_answer_ns) * 1e3, in_seconds(v.reaction_ns) * 1e3,
      in_seconds(v.header_ns) * 1e3, in_seconds(v.silence_ns) * 1e3,
      in_seconds(v.standstill_ns) * 1e3, in_seconds(v.stop_ns) * 1e3);
  return text;
}

}  // namespace g4lidar::simulation
