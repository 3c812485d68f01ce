// SPDX-License-Identifier: MIT
// The stages motor and stream: the scan is started and measured.
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "core/time_limit.hpp"
#include "discovery/fitting_models.hpp"
#include "live_run.hpp"

namespace g4lidar {
namespace {

constexpr session_times times;
constexpr std::int64_t observed_ns = 50 * ms;
/// A scan without bytes for this time has become silent.
constexpr std::int64_t pause_ns = 500 * ms;
/// The time by which the head has its speed.
constexpr std::int64_t spin_up_ns = 6'000 * ms;
/// For the first packet, whatever else arrives; longer than the motor may spin up.
constexpr std::int64_t longest_without_packet_ns = 15'000 * ms;
/// Between two checks of the speed.
constexpr std::int64_t steady_ns = 250 * ms;
/// A device that becomes silent this soon after the start does so because of the start.
constexpr std::int64_t of_the_start_ns = 1'500 * ms;
/// The longest stall or boot: by then bytes arrive again.
constexpr std::int64_t signs_ns = 2'500 * ms;
/// The time at which power-down protection ends a scan without a keep-alive.
constexpr std::int64_t protection_from_ns = 2'600 * ms;
constexpr std::int64_t protection_to_ns = 3'400 * ms;
constexpr unsigned most_restarts = 2;

}  // namespace

void live_run::start_scan() {
  log_.begin(diagnostic_activity::starting);
  if (lidar_.is_driven_by_dtr()) has_motor_line_ = pulse_dtr(link_);
  link_.send(command::start);
  started_ = {
      .sent_ns = link_.now_ns(), .kept_alive_ns = link_.now_ns(), .boots_before = link_.boots()};
}

void live_run::follow(const observed_event& observed) {
  if (std::holds_alternative<packet_view>(observed.what) && started_.first_packet_ns == 0) {
    started_.first_packet_ns = observed.arrival_ns;
  }
  const auto* response = std::get_if<response_view>(&observed.what);
  if (response == nullptr) return;
  started_.has_introduced_itself |= response->kind() == response_kind::device_info;
  started_.has_header |= response->kind() == response_kind::scan_started;
}

std::int64_t live_run::patience_ns() const {
  const bool has_packets = started_.first_packet_ns != 0;
  if (has_packets || link_.boots() > started_.boots_before) return pause_ns;
  return started_.has_header ? times.first_packet_ns : times.start_ns;
}

live_run::scan_state live_run::listen_once(stream_statistics& measured) {
  observer to;
  to.event = [&](const observed_event& observed) {
    measured.take(observed);
    follow(observed);
  };
  to.arrival = [&](const timed_read& observed) { measured.take(observed); };
  if (keeps_alive_ && link_.now_ns() >= started_.kept_alive_ns + times.keep_alive_ns) {
    link_.send(command::start);
    started_.kept_alive_ns = link_.now_ns();
  }
  const std::int64_t until_ns = link_.now_ns() + observed_ns;
  link_.set_cut_off_after(signs_ns);
  link_.listen(until_ns, to);
  link_.set_cut_off_after();
  if (link_.is_over()) return scan_state::over;
  const std::int64_t patience = patience_ns();
  const std::int64_t since_ns = std::max(link_.heard_ns(), started_.sent_ns);
  if (patience == times.first_packet_ns && link_.now_ns() >= since_ns + times.spin_up_notice_ns &&
      !std::exchange(started_.is_spinning_up, true)) {
    log_.begin(diagnostic_activity::spinning_up);
  }
  return link_.now_ns() >= since_ns + patience ? scan_state::silent : scan_state::runs;
}

live_run::scan_state live_run::warm_up(stream_statistics& measured) {
  std::int64_t until_ns = link_.now_ns() + spin_up_ns;
  std::int64_t looked_ns = link_.now_ns();
  while (link_.now_ns() < until_ns) {
    const scan_state state = listen_once(measured);
    if (state != scan_state::runs) return state;
    if (is_of_other_size() && lidar_.is_named) return scan_state::over;
    if (follow_samples()) measured = stream_statistics(*lidar_.which);
    if (started_.first_packet_ns == 0) {
      // A device that boots again and again is never silent.
      if (link_.now_ns() > started_.sent_ns + longest_without_packet_ns) return scan_state::silent;
      until_ns = link_.now_ns() + spin_up_ns;
    }
    if (link_.now_ns() < looked_ns + steady_ns) continue;
    if (measured.is_steady()) return scan_state::runs;
    looked_ns = link_.now_ns();
  }
  return scan_state::runs;
}

/// Whether the packets have samples of another size than the model.
bool live_run::is_of_other_size() const {
  const layout_recogniser& seen = link_.survey().layout();
  const std::size_t size = seen.sample_bytes();
  const std::size_t own = sample_size(lidar_.which->samples.layout);
  return size != 0 && size != own && seen.votes(own) == 0 && seen.votes(size) >= certain_packets;
}

/// The number may be that of another model: its packets decide. Whether they are read in another way from here on.
bool live_run::follow_samples() {
  const layout_recogniser& seen = link_.survey().layout();
  const std::size_t size = seen.sample_bytes();
  // The sample rate of a revolution may decide.
  constexpr std::uint32_t most_packets = 256;
  const bool has_stated = seen.has_stated_all() || seen.votes(size) >= most_packets;
  if (!is_of_other_size() || !has_stated) return false;
  auto fitting = models_at_rate({.baud = link_.port().baud(),
                                 .is_baud_certain = lidar_.has_baud,
                                 .sample_bytes = size,
                                 .sample_rate_hz = seen.rate_hz(),
                                 .frequency_chz = seen.frequency_chz(),
                                 .answers = presence::yes});
  if (fitting.empty()) return false;
  const std::string samples = "samples have " + std::to_string(size) + " bytes, as those of " +
                              one_of(*fitting.front()) + ": it is read as that one.";
  const bool has_number =
      device_.information && detail::may_report(*lidar_.which, device_.information->model);
  reading_ = has_number ? "Its number is that of " + one_of(*lidar_.which) + ", and its " + samples
                        : "Its " + samples;
  lidar_.which = fitting.front();
  lidar_.candidates = std::move(fitting);
  link_.read_as(*lidar_.which);
  return true;
}

bool live_run::start_motor() {
  stage_report motor{.stage = diagnostic_stage::motor};
  measured_ = stream_statistics(*lidar_.which);
  const bool is_started = !lidar_.is_deaf && talks();
  if (is_started) {
    start_scan();
  } else {
    started_.sent_ns = started_.kept_alive_ns = link_.now_ns();
    started_.boots_before = link_.boots();
  }
  scan_state state = warm_up(measured_);
  const bool had_packets = measured_.tally().counts.packets > 0;
  if (had_packets && state == scan_state::runs) {
    motor.add("spin_up_ms", (link_.now_ns() - started_.sent_ns) / ms);
    motor.add("first_packet_ms", (started_.first_packet_ns - started_.sent_ns) / ms);
    if (!is_started) motor.measurements.clear();
  }
  if (state == scan_state::silent) {
    const fate what = fate_of_silent();
    if (what == fate::resumed) {
      find_stall();
      state = warm_up(measured_);
    }
    if (what == fate::booted) motor.find(diagnosis::reboots);
    if (what == fate::dead) {
      const bool is_of_start = is_started && !replies_.has_died(*lidar_.which);
      motor.find(is_of_start ? diagnosis::brown_out : diagnosis::stalls);
      motor.add("silence_ms", (link_.now_ns() - std::max(link_.heard_ns(), started_.sent_ns)) / ms);
    }
    if (what == fate::answers) {
      motor.find(had_packets ? diagnosis::reboots : of_never_started());
      if (lidar_.is_driven_by_dtr() && !has_motor_line_) {
        motor.remark = "This connection has no line DTR, which starts the motor of " +
                       one_of(*lidar_.which) + ".";
      }
    }
  }
  if (state == scan_state::runs) judge_motor(motor, measured_);
  if (!reading_.empty()) {
    const auto is_reported = [](const stage_report& each) {
      return !each.diagnoses.empty() && each.diagnoses.front() == diagnosis::other_number;
    };
    if (device_.information && std::ranges::none_of(log_.stages(), is_reported)) {
      motor.find(diagnosis::other_number);
    }
    motor.remark = reading_;
  }
  if (lidar_.is_named && is_of_other_size()) {
    find_other_layout(motor, link_.survey().layout(), *lidar_.which);
  }
  add_failure(motor);
  const bool runs = state == scan_state::runs && !link_.is_over();
  log_.report(std::move(motor));
  return runs;
}

// A start that it confirms with the scan header has reached it. Bytes without a packet are no motor that stands.
diagnosis live_run::of_never_started() const noexcept {
  if (measured_.has_become_garbage()) return diagnosis::line_noise;
  const bool lacks_power = lidar_.is_driven_by_dtr() && started_.has_header;
  return lacks_power ? diagnosis::no_motor_power : diagnosis::does_not_start;
}

bool live_run::is_host_busy() const noexcept { return link_.host_paused_ns() > started_.sent_ns; }

void live_run::find_stall() {
  stream_.find(is_host_busy() ? diagnosis::host_busy : diagnosis::stalls);
  if (!is_host_busy()) longest_gap_ns_ = std::max(longest_gap_ns_, gap_ns_);
}

// It gets no command before it has had the time to continue by itself.
live_run::fate live_run::fate_of_silent() {
  const std::uint64_t before = link_.counts().packets;
  const std::int64_t since_ns = std::max(link_.heard_ns(), started_.sent_ns);
  std::int64_t until_ns = link_.now_ns() + signs_ns;
  std::int64_t back_ns = 0;
  observer to;
  to.event = [&](const observed_event& observed) {
    follow(observed);
    if (link_.counts().packets > before) until_ns = 0;
  };
  to.arrival = [&](const timed_read& observed) {
    if (back_ns == 0) back_ns = observed.arrival_ns;
  };
  link_.listen(until_ns, to);
  gap_ns_ = (back_ns != 0 ? back_ns : link_.now_ns()) - since_ns;
  if (link_.counts().packets > before) return fate::resumed;
  if (link_.is_over()) return fate::over;
  if (link_.boots() > started_.boots_before || started_.has_introduced_itself) return fate::booted;
  constexpr int most = 3;
  for (int i = 0; i < most && !link_.is_over() && talks(); ++i) {
    // Some models ignore queries as long as they scan.
    if (i == most - 1) link_.stop();
    const exchange made = link_.ask(command::device_info, 800 * ms);
    if (made.packets > 0) return fate::resumed;
    if (!made.heard_nothing()) return fate::answers;
  }
  return link_.is_over() ? fate::over : fate::dead;
}

void live_run::measure_scan() {
  measured_.begin();
  const std::int64_t begin_ns = link_.now_ns();
  std::int64_t until_ns = begin_ns + limited_ns(log_.options().measuring_time);
  while (link_.now_ns() < until_ns) {
    const scan_state state = listen_once(measured_);
    if (state == scan_state::over) break;
    if (state == scan_state::silent && !revive(until_ns)) break;
  }
  measured_ns_ = link_.now_ns() - begin_ns;
}

bool live_run::revive(std::int64_t& until_ns) {
  const std::int64_t lasted_ns = link_.heard_ns() - started_.sent_ns;
  const std::int64_t unkept_ns = link_.heard_ns() - started_.kept_alive_ns;
  switch (fate_of_silent()) {
    case fate::resumed:
      find_stall();
      measured_.part();
      return true;
    case fate::booted:
      stream_.find(diagnosis::reboots);
      return false;
    case fate::dead:
      stream_.find(lasted_ns < of_the_start_ns && talks() ? diagnosis::brown_out
                                                          : diagnosis::stalls);
      longest_gap_ns_ = std::max(longest_gap_ns_, link_.now_ns() - link_.heard_ns());
      return false;
    case fate::over:
      return false;
    case fate::answers:
      break;
  }
  const bool may_be_protected = lidar_.which->protection != presence::no && !keeps_alive_ &&
                                unkept_ns >= protection_from_ns && unkept_ns <= protection_to_ns;
  const bool is_starved = keeps_alive_ && is_host_busy();  // by the host
  if (!may_be_protected && !is_starved) stream_.find(diagnosis::scan_ends);
  if (restarts_ == most_restarts) return false;
  keeps_alive_ = keeps_alive_ || may_be_protected;
  if (!restart_scan(until_ns)) return false;
  if (may_be_protected) stream_.find(diagnosis::protection_on);
  return true;
}

bool live_run::restart_scan(std::int64_t& until_ns) {
  ++restarts_;
  stream_statistics warming(*lidar_.which);
  start_scan();
  if (warm_up(warming) != scan_state::runs) return false;
  // With keep-alive commands it must last longer than without.
  while (keeps_alive_ && link_.now_ns() < started_.sent_ns + protection_to_ns) {
    if (listen_once(warming) != scan_state::runs) {
      stream_.find(diagnosis::scan_ends);
      return false;
    }
  }
  measured_.part();
  until_ns = std::max(until_ns, link_.now_ns() + limited_ns(log_.options().measuring_time) / 2);
  return true;
}

void live_run::report_stream() {
  if (link_.sample_bytes() != 0) stream_.add("bytes_per_sample", link_.sample_bytes());
  if (longest_gap_ns_ > 0) measured_.take(timed_read{0, link_.now_ns(), longest_gap_ns_});
  judge_stream(stream_, measured_, static_cast<double>(measured_ns_) / 1e9);
  if (restarts_ > 0) stream_.add("restarts", restarts_);
  add_failure(stream_);
  log_.report(std::move(stream_));
}

}  // namespace g4lidar
