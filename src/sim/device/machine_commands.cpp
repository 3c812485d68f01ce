// SPDX-License-Identifier: MIT
// Commands and answers.
#include "sim/exact.hpp"

#include "machine.hpp"

#include <algorithm>
#include <utility>

namespace g4lidar::sim {

void device::machine::host_byte_arrives() noexcept {
  std::uint8_t byte = from_host_.take_byte();
  if (faults_.find(fault_kind::baud) != nullptr) {
    byte = static_cast<std::uint8_t>(garbage_.next() >> 56);
  }
  const bool is_deaf = options_.one_way || faults_.find(fault_kind::deaf) != nullptr;
  if (!is_up() || is_deaf) return from_host_.ignore();
  from_host_.hear(byte, now_ns_, options_.reaction_ns);
}

void device::machine::execute(const pending_command& asked_for) noexcept {
  const bool scanning = is_scanning();
  const bool obeyed = obey(static_cast<command>(asked_for.code));
  log.add({asked_for.asked_ns, asked_for.code, obeyed, scanning});
}

bool device::machine::obey(command code) noexcept {
  const std::optional<command_traits> traits = traits_of(code);
  if (!traits) return false;
  if (is_scanning() && !traits->allowed_while_scanning &&
      options_.while_scanning == disturbance::ignored) {
    return false;
  }
  switch (code) {
    case command::forced_stop:
      if (!options_.obeys_forced_stop) return false;
      stop_scan();
      return true;
    case command::stop:
      stop_scan();
      return true;
    case command::start:
      return obey_start();
    case command::device_info:
      answer(answer_with(options_.info));
      return true;
    case command::health:
      if (options_.answers_health_91) answer(answer_with(condition()));
      return options_.answers_health_91;
    case command::health_vendor:
      if (options_.answers_health_92) answer(answer_with(condition()));
      return options_.answers_health_92;
    case command::restart:
      if (options_.obeys_restart_80) restart();
      return options_.obeys_restart_80;
    case command::restart_old:
      if (options_.obeys_restart_40) restart();
      return options_.obeys_restart_40;
    default:
      return obey_setting(code);
  }
}

bool device::machine::obey_setting(command code) noexcept {
  const power_down_protection before = settings.protection;
  const std::optional<answer_bytes> answered = apply(code, settings, options_);
  if (!answered) return false;
  if (settings.protection != before) fed_ns_ = now_ns_;
  use_settings();
  keep_motor();
  answer(*answered);
  return true;
}

void device::machine::use_settings() noexcept {
  const bool clockwise = settings.direction == motor_direction::clockwise;
  sampler_.set(settings.sample_rate, clockwise ? turning::clockwise : options_.counter_clockwise);
  head.hold(settings.constancy);
}

bool device::machine::obey_start() noexcept {
  if (condition().status == health_status::error && options_.error_refuses_start) return false;
  fed_ns_ = now_ns_;
  if (is_scanning()) {
    sampler_.end_at(forever_ns);  // a stop that has not ended the scan yet has no effect
    if (options_.start_again_answers) answer(answer_with(response_kind::scan_started, {}));
    return true;
  }
  if (!stopped_by_protection_ || options_.header_after_protection) {
    answer_bytes header = answer_with(response_kind::scan_started, {});
    if (options_.stray_after_start) header.data[header.size++] = 0x00;
    answer(header, options_.header_ns);
  }
  sampler_.silence_until(now_ns_ + options_.header_ns + options_.silence_ns);
  begin_scan();
  return true;
}

health device::machine::condition() const noexcept {
  if (const fault* bad = faults_.find(fault_kind::health)) {
    return {static_cast<health_status>(bad->amount), 1};
  }
  return options_.condition;
}

void device::machine::restart() noexcept { power_on(options_.settings_outlive_restart); }

void device::machine::answer(answer_bytes what, std::int64_t later_ns) noexcept {
  if (answers_.begin_answer()) later_ns += options_.first_answer_ns;
  if (faults_.strike(fault_kind::mute) != nullptr) return;
  if (faults_.strike(fault_kind::wrong) != nullptr) what = another_than(what);
  const bool twice = faults_.strike(fault_kind::twice) != nullptr;
  const fault* const late = faults_.strike(fault_kind::late);
  if (late != nullptr) later_ns += late->amount;
  for (int times = twice ? 2 : 1; times > 0; --times) {
    if (later_ns > 0) {
      answers_.add(what, now_ns_ + later_ns);
    } else {
      send(what);
    }
  }
}

// A possible answer to a query of another kind.
answer_bytes device::machine::another_than(const answer_bytes& right) noexcept {
  const std::array others{
      answer_with(response_kind::byte,
                  std::array{static_cast<std::uint8_t>(faults_.draw(fault_kind::wrong, 2))}),
      answer_with(response_kind::frequency, std::array<std::uint8_t, 4>{0xBC, 0x02, 0, 0}),
      answer_with(condition()), answer_with(options_.info)};
  auto which = static_cast<std::size_t>(faults_.draw(fault_kind::wrong, others.size()));
  if (others[which].size == right.size) which = (which + 1) % others.size();
  return others[which];
}

/// A stopped device sends no header; a header that a fault has delayed is still sent.
void device::machine::forget_header() noexcept {
  if (options_.header_ns > 0) answers_.remove(answer_with(response_kind::scan_started, {}));
}

void device::machine::send(const answer_bytes& what) noexcept {
  if (!is_scanning() || options_.while_scanning == disturbance::between) {
    return wire_.send(what.view(), now_ns_);
  }
  if (options_.while_scanning == disturbance::drops) wire_.cut_front();
  wire_.interject(what, now_ns_);
}

}  // namespace g4lidar::sim
