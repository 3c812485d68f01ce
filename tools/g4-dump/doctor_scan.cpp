// SPDX-License-Identifier: MIT
// The stages from the motor on: the scan is started, listened to, and judged.
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "doctor_exam.hpp"

namespace g4_dump {
namespace {

using namespace g4lidar;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t slice_ns = 50 * ms;
/// A scan that sends nothing for so long has fallen silent.
constexpr std::int64_t silence_ns = 500 * ms;
/// The pause of an answer.
constexpr std::int64_t frame_pause_ns = 60 * ms;
constexpr std::int64_t first_packet_ns = 1'500 * ms;
/// The head has its speed by then.
constexpr std::int64_t spin_up_ns = 6'000 * ms;
/// Between two looks at the speed; and how far it may have moved.
constexpr std::int64_t steady_ns = 250 * ms;
constexpr double steady_ratio = 0.01;
/// Slower than that from sample to sample, it stands.
constexpr double standing_deg = 0.02;
/// What dies so soon after the start has died of it.
constexpr std::int64_t of_the_start_ns = 1'500 * ms;
/// A stall, a boot: by then something is heard again.
constexpr std::int64_t signs_ns = 2'500 * ms;
/// The power-down protection ends a scan that is not fed then.
constexpr std::int64_t protection_from_ns = 2'600 * ms;
constexpr std::int64_t protection_to_ns = 3'400 * ms;
constexpr std::int64_t feed_ns = 1'000 * ms;
constexpr unsigned most_restarts = 2;
constexpr double frequency_tolerance = 0.06;
constexpr double sample_rate_tolerance = 0.12;
/// More than a bridge's packet of 64 bytes at 230400 baud.
constexpr double held_back_limit_ms = 3.3;
/// As little damage as this only deserves a warning.
constexpr std::uint64_t few_events = 2;
constexpr double few_lost = 0.002;

bool is_introduction(const event& came) noexcept {
  const auto* response = std::get_if<response_view>(&came);
  return response != nullptr && response->kind() == response_kind::device_info;
}

}  // namespace

void examination::start_scan() {
  ear_.send(command::start);
  started_ns_ = ear_.now_ns();
  fed_ns_ = started_ns_;
  boots_then_ = ear_.boots();
  introduced_itself_ = false;
}

examination::scan_state examination::listen_once(stream_watch& watch) {
  listener to;
  to.event = [&](const heard& came) {
    watch.take(came);
    introduced_itself_ = introduced_itself_ || is_introduction(came.what);
  };
  to.arrival = [&](const batch& came) { watch.take(came); };
  if (feeds_ && ear_.now_ns() >= fed_ns_ + feed_ns) {
    ear_.send(command::start);
    fed_ns_ = ear_.now_ns();
  }
  const std::int64_t until_ns = ear_.now_ns() + slice_ns;
  ear_.give_frames(signs_ns);
  ear_.listen(until_ns, to);
  ear_.give_frames(frame_pause_ns);
  if (ear_.is_over()) return scan_state::over;
  const std::int64_t patience_ns = watch.last_packet_ns() > 0 ? silence_ns : first_packet_ns;
  const std::int64_t since_ns = std::max(ear_.heard_ns(), started_ns_);
  return ear_.now_ns() >= since_ns + patience_ns ? scan_state::silent : scan_state::runs;
}

examination::scan_state examination::warm_up(stream_watch& watch, std::int64_t longest_ns) {
  const std::int64_t until_ns = ear_.now_ns() + longest_ns;
  double before_deg = 0.0;
  std::int64_t before_ns = ear_.now_ns();
  is_steady_ = false;
  while (ear_.now_ns() < until_ns) {
    const scan_state state = listen_once(watch);
    if (state != scan_state::runs) return state;
    if (ear_.now_ns() < before_ns + steady_ns) continue;
    const double step_deg = watch.step_deg().value_or(0.0);
    is_steady_ =
        step_deg > standing_deg && std::abs(step_deg - before_deg) < steady_ratio * step_deg;
    if (is_steady_) return scan_state::runs;
    before_deg = step_deg;
    before_ns = ear_.now_ns();
  }
  return scan_state::runs;
}

bool examination::start_motor() {
  stage_report motor{.where = stage::motor};
  if (!is_deaf_) start_scan();
  scan_state state = warm_up(watch_, spin_up_ns);
  const bool had_packets = watch_.counts().packets > 0;
  if (had_packets && state == scan_state::runs) {
    motor.add("spin_up_ms", (ear_.now_ns() - started_ns_) / ms);
    if (is_deaf_) motor.facts.clear();
  }
  if (state == scan_state::silent) {
    const fate what = fate_of_silent();
    if (what == fate::resumed) {
      stream_.find(diagnosis::stalls);
      state = warm_up(watch_, spin_up_ns);
    }
    if (what == fate::booted) motor.find(diagnosis::reboots);
    if (what == fate::dead) {
      motor.find(book_.has_died() ? diagnosis::stalls : diagnosis::brown_out);
    }
    if (what == fate::answers) {
      motor.find(had_packets ? diagnosis::reboots : diagnosis::does_not_start);
    }
  }
  if (state == scan_state::runs && watch_.counts().packets > 30 && !is_steady_) {
    const bool stands = watch_.step_deg().value_or(0.0) <= standing_deg;
    motor.find(stands ? diagnosis::motor_stuck : diagnosis::motor_unsteady);
  }
  note_loss(motor);
  const bool runs = state == scan_state::runs && !ear_.is_over();
  tell(std::move(motor));
  return runs;
}

// It is not told anything before it has had the time to go on by itself.
examination::fate examination::fate_of_silent() {
  bool has_packets = false;
  std::int64_t until_ns = ear_.now_ns() + signs_ns;
  listener to;
  to.event = [&](const heard& came) {
    has_packets = has_packets || std::holds_alternative<packet_view>(came.what);
    introduced_itself_ = introduced_itself_ || is_introduction(came.what);
    if (has_packets) until_ns = 0;
  };
  ear_.listen(until_ns, to);
  if (has_packets) return fate::resumed;
  if (ear_.is_over()) return fate::over;
  if (ear_.boots() > boots_then_ || introduced_itself_) return fate::booted;
  for (int i = 0; i < 2 && !ear_.is_over(); ++i) {
    const exchange made = ear_.ask(command::device_info, 800 * ms);
    if (made.packets > 0) return fate::resumed;
    if (!made.heard_nothing()) return fate::answers;
  }
  return ear_.is_over() ? fate::over : fate::dead;
}

void examination::listen_to_scan() {
  watch_.begin(ear_.now_ns());
  const std::int64_t begin_ns = ear_.now_ns();
  std::int64_t until_ns = begin_ns + options_.listen_ns;
  while (ear_.now_ns() < until_ns) {
    const scan_state state = listen_once(watch_);
    if (state == scan_state::over) break;
    if (state == scan_state::silent && !revive(until_ns)) break;
  }
  listened_ns_ = ear_.now_ns() - begin_ns;
}

bool examination::revive(std::int64_t& until_ns) {
  const std::int64_t lived_ns = ear_.heard_ns() - started_ns_;
  const std::int64_t unfed_ns = ear_.heard_ns() - fed_ns_;
  switch (fate_of_silent()) {
    case fate::resumed:
      stream_.find(diagnosis::stalls);
      watch_.part();
      return true;
    case fate::booted:
      stream_.find(diagnosis::reboots);
      return false;
    case fate::dead:
      stream_.find(lived_ns < of_the_start_ns ? diagnosis::brown_out : diagnosis::stalls);
      return false;
    case fate::over:
      return false;
    case fate::answers:
      break;
  }
  const bool may_be_unfed =
      !feeds_ && unfed_ns >= protection_from_ns && unfed_ns <= protection_to_ns;
  if (!may_be_unfed) stream_.find(diagnosis::scan_ends);
  if (restarts_ == most_restarts) return false;
  feeds_ = feeds_ || may_be_unfed;
  if (!restart_scan(until_ns)) return false;
  if (may_be_unfed) stream_.find(diagnosis::protection_on);
  return true;
}

bool examination::restart_scan(std::int64_t& until_ns) {
  ++restarts_;
  stream_watch warming;
  start_scan();
  if (warm_up(warming, spin_up_ns) != scan_state::runs) return false;
  // With what feeds it, it must live longer than without.
  while (feeds_ && ear_.now_ns() < started_ns_ + protection_to_ns) {
    if (listen_once(warming) != scan_state::runs) {
      stream_.find(diagnosis::scan_ends);
      return false;
    }
  }
  watch_.part();
  until_ns = std::max(until_ns, ear_.now_ns() + options_.listen_ns / 2);
  return true;
}

void examination::tell_stream() {
  const stream_counts& counts = watch_.counts();
  stream_.add("seconds", static_cast<double>(listened_ns_) / 1e9);
  stream_.add("bytes", watch_.bytes());
  stream_.add("packets", counts.packets);
  stream_.add("points", counts.points);
  if (watch_.jerks() > 0) stream_.add("jerks", watch_.jerks());
  stream_.add("longest_silence_ms", watch_.longest_silence_ns() / ms);
  if (watch_.stalls() > 0) {
    stream_.add("stalls", watch_.stalls());
    if (stream_.found.empty()) stream_.find(diagnosis::stalls);  // else it is told why
  }
  if (restarts_ > 0) stream_.add("restarts", restarts_);
  if (watch_.has_become_garbage()) {
    stream_.add("bytes_since_last_packet", watch_.bytes_since_packet());
    stream_.find(diagnosis::wrong_baud_rate);
  }
  // Where much is damaged, some of it passes the checksum and looks like that.
  if (20 * watch_.jerks() > watch_.damage().changed && is_steady_) stream_.find(diagnosis::jolts);
  note_loss(stream_);
  tell(std::move(stream_));
}

void examination::tell_rate() {
  const double frequency_hz = watch_.frequency_hz();
  const double rate_hz = watch_.sample_rate_hz();
  if (frequency_hz <= 0.0) return skip(stage::rate, "Too little came to measure it.");
  stage_report rate{.where = stage::rate};
  rate.add("measured_hz", frequency_hz);
  if (watch_.reported_hz() > 0.0) rate.add("reported_hz", watch_.reported_hz());
  if (portrait_.frequency_chz) {
    const double set_hz = *portrait_.frequency_chz / 100.0;
    rate.add("set_hz", set_hz);
    const bool is_off = std::abs(frequency_hz - set_hz) > frequency_tolerance * set_hz;
    if (is_off && is_steady_) rate.find(diagnosis::frequency_off);
  }
  rate.add("samples_per_s", rate_hz);
  if (portrait_.ranging) {
    const double nominal_hz = samples_per_second(*portrait_.ranging);
    rate.add("nominal_samples_per_s", nominal_hz);
    const bool is_off = std::abs(rate_hz - nominal_hz) > sample_rate_tolerance * nominal_hz;
    if (is_off) rate.find(diagnosis::sample_rate_off);
  }
  tell(std::move(rate));
}

void examination::tell_loss() {
  const stream_counts& counts = watch_.counts();
  if (watch_.bytes() == 0) return skip(stage::loss, "Nothing came.");
  stage_report loss{.where = stage::loss};
  const double all = static_cast<double>(watch_.samples() + watch_.samples_lost());
  const double lost = static_cast<double>(watch_.samples_lost()) / std::max(all, 1.0);
  loss.add("lost_percent", 100.0 * lost);
  loss.add("samples_lost", watch_.samples_lost());
  for (const auto reason : {skip_reason::noise, skip_reason::bad_header, skip_reason::bad_checksum,
                            skip_reason::truncated}) {
    loss.add(std::string("skipped_") + g4lidar::name_of(reason), counts.skipped(reason));
  }
  const damage_counts& damage = watch_.damage();
  for (const auto& [name, count] :
       {std::pair("changed", damage.changed), std::pair("shortened", damage.shortened),
        std::pair("cut", damage.cut), std::pair("lengthened", damage.lengthened),
        std::pair("vanished", damage.vanished), std::pair("unclear", damage.unclear)}) {
    if (count > 0) loss.add(name, count);
  }
  if (damage.one_packet > 0) {
    loss.add("wrong_bits_in_a_checksum",
             static_cast<double>(damage.wrong_bits) / static_cast<double>(damage.one_packet));
  }
  if (is_steady_) {
    for (const diagnosis what : diagnoses_of(watch_)) loss.find(what);
  }
  if (!loss.found.empty() && damage.all() <= few_events) {
    loss.remark = "This is little to tell the cause by: listen longer with -d.";
  }
  if (damage.all() <= few_events && lost < few_lost) loss.how = std::min(loss.how, verdict::warn);
  tell(std::move(loss));
}

void examination::tell_latency() {
  const double held_ms = watch_.held_back_ms(baud_);
  if (baud_ == 0 || watch_.bytes() == 0) {
    return skip(stage::usb_latency, "Nothing came to measure it by.");
  }
  stage_report latency{.where = stage::usb_latency};
  latency.add("held_back_ms", held_ms);
  if (held_ms > held_back_limit_ms) latency.find(diagnosis::usb_latency);
  tell(std::move(latency));
}

}  // namespace g4_dump
