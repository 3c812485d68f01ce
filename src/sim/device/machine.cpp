// SPDX-License-Identifier: MIT
// The order of events, the power, and the USB plug.
#include "sim/exact.hpp"

#include "machine.hpp"

#include <algorithm>
#include <cassert>
#include <initializer_list>
#include <string_view>

#include "sim/purpose.hpp"

namespace g4lidar::sim {
namespace {

// After the last keep-alive of the host.
constexpr std::int64_t protection_ns = 3'000'000'000;

constexpr std::string_view boot_words = "G4 lidar booting\r\nmotor ok, laser ok, memory ok\r\n";

bytes text_bytes(std::string_view text) noexcept {
  // Characters are bytes.
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

device::machine::machine(const world& scene, const device_options& wanted,
                         std::span<const fault> with_faults)
    : options(wanted),
      faults(with_faults, wanted.scanner.seed),
      to_host(wanted),
      output(scene, options, faults),
      log(wanted.log_capacity),
      settings(first_settings(wanted)),
      head(wanted),
      host(wanted),
      from_host_(wanted.scanner.seed),
      answers_(options, faults),
      garbage_(stream_for(wanted.scanner.seed, purpose::garbage)) {
  assert(problem_with(options).empty());
  assert(std::all_of(with_faults.begin(), with_faults.end(),
                     [](const fault& f) { return problem_with(f).empty(); }));
  use_settings();
  if (options.boots_at_start) {
    power_on(true);
  } else {
    keep_motor();
    if (options.one_way) begin_scan(true);
  }
  advance(0);
}

device::machine::event device::machine::next_event() const noexcept {
  event first{forever_ns, happening::fault_edge};
  const auto consider = [&first](std::int64_t at_ns, happening kind) {
    if (at_ns < first.at_ns) first = {at_ns, kind};
  };
  consider(faults.next_edge_ns(), happening::fault_edge);
  consider(from_host_.next_byte_ns(), happening::host_byte);
  consider(from_host_.next_command_ns(), happening::command_due);
  consider(answers_.queue.next_ns(), happening::answer_due);
  consider(output.samples.next_ns(), happening::packet_measured);
  consider(output.samples.end_ns(), happening::scan_end);
  if (is_scanning() && settings.protection == power_down_protection::on) {
    consider(fed_ns_ + protection_ns, happening::protection);
  }
  consider(booted_ns_, happening::booted);
  consider(death_ns_, happening::death);
  consider(output.line.next_ns(), happening::byte_sent);
  consider(output.rest_ns(), happening::line_rests);
  consider(to_host.next_ns(), happening::batch_done);
  return first;
}

void device::machine::advance(std::int64_t wanted_ns) noexcept {
  constexpr std::int64_t last_ns = std::int64_t{1} << 62U;  // so that more can be added to it
  const std::int64_t to_ns = std::min(wanted_ns, last_ns);
  for (event next = next_event(); next.at_ns <= to_ns; next = next_event()) {
    if (next.at_ns == forever_ns) return;
    now_ns_ = std::max(now_ns_, next.at_ns);
    handle(next.what);
  }
  now_ns_ = std::max(now_ns_, to_ns);
}

void device::machine::handle(happening what) noexcept {
  switch (what) {
    case happening::fault_edge:
      return update_supply();
    case happening::host_byte:
      return host_byte_arrives();
    case happening::command_due:
      return execute(from_host_.take_command());
    case happening::answer_due:
      return answers_.queue.take_due(
          now_ns_, [this](const answer_bytes& due) { output.send(due, is_scanning(), now_ns_); });
    case happening::packet_measured:
      if (options.driven_by == drive::commands || head.speed_mhz(now_ns_) != 0) {
        output.send_packet(now_ns_);
      }
      return output.measure(head, settings.direction);
    case happening::scan_end:
      return end_scan();
    case happening::protection:
      stopped_by_protection_ = true;
      return end_scan();
    case happening::booted:
      return booted();
    case happening::death:
      return death();
    case happening::byte_sent:
      return output.byte_sent(to_host, host.baud(), now_ns_);
    case happening::line_rests:
      return output.rest(to_host, now_ns_);
    case happening::batch_done:
      return to_host.flush(faults);
  }
}

// The next event for the host is a batch; if none is open, it cannot end before the next byte.
std::int64_t device::machine::next_ns(std::int64_t now_ns) const noexcept {
  if (to_host.available() > 0) return now_ns;
  std::int64_t next = next_event().at_ns;
  if (to_host.next_ns() != forever_ns && next == output.line.next_ns()) {
    // More bytes for an open batch end no wait; anything else may.
    next = to_host.next_ns();
    for (const std::int64_t at : {faults.next_edge_ns(), booted_ns_, death_ns_}) {
      next = std::min(next, at);
    }
  }
  return std::max(next, now_ns);
}

bool device::machine::is_silent() const noexcept {
  return output.line.is_silent() && to_host.next_ns() == forever_ns && from_host_.is_empty() &&
         answers_.queue.next_ns() == forever_ns;
}

void device::machine::write(bytes from_host) noexcept {
  if (plug.is_in()) from_host_.write(from_host, host.baud(), now_ns_);
}

void device::machine::update_supply() noexcept {
  faults.set_time(now_ns_);
  if (plug.update(faults.find(fault_kind::unplug) != nullptr)) {
    browned_out_ = false;
    if (!plug.is_in()) {
      to_host.reset();
      from_host_.unplug();
      host.unplug(now_ns_);
    }
  }
  if (faults.find(fault_kind::brown_out) == nullptr) browned_out_ = false;
  const bool by_dtr = options.driven_by == drive::dtr_line;
  const bool is_cut = by_dtr && options.dtr_cuts == dtr_cut::supply && !host.enables();
  const bool has_supply = plug.is_in() && !browned_out_ && !is_cut;
  if (has_supply && state_ == state::off) {
    power_on(options.settings_outlive_power);
  } else if (!has_supply && state_ != state::off) {
    power_off();
  } else if (by_dtr) {
    keep_motor();
  }
  if (faults.begins(fault_kind::scanning) && state_ == state::idle) {
    begin_scan(now_ns_ == 0);
  }
}

void device::machine::power_off() noexcept {
  state_ = state::off;
  booted_ns_ = death_ns_ = forever_ns;
  output.samples.end();
  answers_.queue.clear();
  from_host_.power_off();
  output.line.reset();
  output.of_host.reset();
  stopped_by_protection_ = false;
  keep_motor();
}

void device::machine::power_on(bool keep_settings) noexcept {
  power_off();
  if (!keep_settings) {
    settings = first_settings(options);
    use_settings();
  }
  answers_.queue.boot();
  state_ = state::booting;
  booted_ns_ = now_ns_ + options.boot_ns;
}

void device::machine::booted() noexcept {
  booted_ns_ = forever_ns;
  state_ = state::idle;
  if (options.boot_text) output.line.send(text_bytes(boot_words), now_ns_);
  if (options.boot_information) output.send(answer_with(options.info), false, now_ns_);
  keep_motor();
  if (options.one_way) static_cast<void>(obey_start());
}

// The motor has lowered the supply voltage too far.
void device::machine::death() noexcept {
  death_ns_ = forever_ns;
  if (faults.find(fault_kind::brown_out) != nullptr) {
    power_off();
    browned_out_ = true;
  } else if (faults.find(fault_kind::reboot) != nullptr) {
    power_on(options.settings_outlive_power);
  }
}

}  // namespace g4lidar::sim
