// SPDX-License-Identifier: MIT
// Commands and answers.
#include "sim/exact.hpp"

#include "machine.hpp"

namespace g4lidar::sim {
namespace {

constexpr command_set allowed_while_scanning{0x00, 0x60, 0x65};

}  // namespace

// At another rate than that of the device it arrives as other bytes.
void device::machine::host_byte_arrives() noexcept {
  from_host_.receive(now_ns_, host.baud(), options.any_baud ? host.baud() : options.baud,
                     [this](std::uint8_t byte) {
                       if (faults.find(fault_kind::baud) != nullptr) {
                         byte = static_cast<std::uint8_t>(garbage_.next() >> 56);
                       }
                       const bool is_deaf =
                           options.one_way || faults.find(fault_kind::deaf) != nullptr;
                       if (!is_up() || is_deaf) return from_host_.ignore();
                       from_host_.hear(byte, now_ns_, options.reaction_ns);
                     });
}

void device::machine::execute(const due_command& asked_for) noexcept {
  const bool scanning = is_scanning();
  const bool obeyed = obey(static_cast<command>(asked_for.code));
  log.add({asked_for.asked_ns, asked_for.code, obeyed, scanning});
}

bool device::machine::obey(command code) noexcept {
  const auto number = static_cast<std::uint8_t>(code);
  if (!options.commands.has(number)) return false;
  if (is_scanning() && !allowed_while_scanning.has(number) &&
      options.while_scanning == disturbance::ignored) {
    return false;
  }
  switch (code) {
    case command::forced_stop:
      if (!options.obeys_forced_stop) return false;
      stop_scan();
      return true;
    case command::stop:
      stop_scan();
      return true;
    case command::start:
      return obey_start();
    case command::device_info:
      answer(code, answer_with(options.info));
      return true;
    case command::health:
      if (options.answers_health_91) answer(code, answer_with(answers_.condition()));
      return options.answers_health_91;
    case command::health_vendor:
      if (options.answers_health_92) answer(code, answer_with(answers_.condition()));
      return options.answers_health_92;
    case command::restart:
      if (options.obeys_restart_80) power_on(options.settings_outlive_restart);
      return options.obeys_restart_80;
    case command::restart_old:
      if (options.obeys_restart_40) power_on(options.settings_outlive_restart);
      return options.obeys_restart_40;
    default:
      return obey_setting(code);
  }
}

bool device::machine::obey_setting(command code) noexcept {
  const power_down_protection before = settings.protection;
  const std::optional<answer_bytes> answered = apply(code, settings, options);
  if (!answered) return false;
  if (settings.protection != before) fed_ns_ = now_ns_;
  use_settings();
  keep_motor();
  answer(code, *answered);
  return true;
}

void device::machine::use_settings() noexcept {
  const bool clockwise = settings.direction == motor_direction::clockwise;
  output.samples.set(settings.sample_rate,
                     clockwise ? turning::clockwise : options.counter_clockwise);
  head.hold(settings.constancy);
}

bool device::machine::obey_start() noexcept {
  if (answers_.condition().status == health_status::error && options.error_refuses_start)
    return false;
  fed_ns_ = now_ns_;
  if (is_scanning()) {
    output.samples.end_at(forever_ns);  // a stop that has not ended the scan yet has no effect
    if (options.start_again_answers) {
      answer(command::start, answer_with(response_kind::scan_started, {}));
    }
    return true;
  }
  if (!stopped_by_protection_ || options.header_after_protection) {
    answer_bytes header = answer_with(response_kind::scan_started, {});
    if (options.stray_after_start) header.data[header.size++] = 0x00;
    answer(command::start, header, options.header_ns);
  }
  output.samples.silence_until(now_ns_ + options.header_ns + options.silence_ns);
  begin_scan();
  return true;
}

void device::machine::answer(command to, const answer_bytes& answer,
                             std::int64_t later_ns) noexcept {
  answers_.answer(static_cast<std::uint8_t>(to), answer, later_ns, now_ns_,
                  [this](const answer_bytes& now) { output.send(now, is_scanning(), now_ns_); });
}

}  // namespace g4lidar::sim
