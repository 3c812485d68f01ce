// SPDX-License-Identifier: MIT
#include "running_scan.hpp"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "discovery/fitting_models.hpp"
#include "g4lidar/detail/saturating.hpp"

namespace g4lidar {
void running_scan::begin(bool is_device) {
  is_device_ = is_device;
  splitter_ = event_splitter(which_->samples);
  asked_.reset();
  garbage_ = 0;
  time_ns_ = 0;
  const bool awaits_start = is_device && which_->link == link_kind::two_way;
  enter(awaits_start ? phase::rests : phase::starts);
}

void running_scan::read_as(const model& model) {
  which_ = &model;
  measured_ = stream_statistics(model, true);
}

void running_scan::end() {
  splitter_.finish(to_);
  enter(phase::rests);
}

// What was measured before is of another scan.
void running_scan::enter(phase next) {
  phase_ = next;
  if (next == phase::starts) sizes_.emplace(sample_size(which_->samples.layout));
  boots_ = splitter_.boots();
  may_have_booted_ = false;
  silence_ns_ = 0;
  if (next == phase::speeds_up) {
    begin_.phase_ns = time_ns_;
    looked_ = measured_.tally().samples;
  } else if (next == phase::runs) {
    measured_.begin();
    looked_ = 0;
    begin_.window_ns = begin_.stretch_ns = time_ns_;
  } else {
    measured_.suspend();
    static_cast<void>(measured_.next_stretch());
    earlier_ = {};
  }
}

bool running_scan::is_current(std::int64_t now_ns) const noexcept {
  return phase_ >= phase::speeds_up &&
         detail::saturating_sub(now_ns, packet_ns_) < arrival_statistics::stall_ns;
}

void running_scan::sent(bytes data, std::int64_t now_ns, std::int64_t silence_ns) {
  if (data.size() < 2 || data[0] != command_start) return;
  asked_ = static_cast<command>(data[1]);
  if (phase_ != phase::rests && !is_current(now_ns)) happened_.reboot |= may_have_booted_;
  switch (*asked_) {
    case command::start:
      if (is_current(now_ns)) return;
      if (phase_ == phase::runs && silence_ns >= arrival_statistics::stall_ns) {
        happened_.stall_ns = std::max(happened_.stall_ns, silence_ns);
      }
      return enter(phase::starts);
    case command::stop:
    case command::forced_stop:
    case command::restart:
    case command::restart_old:
      return enter(phase::rests);
    default:
      return;
  }
}

void running_scan::received(const timed_read& arrived, bytes data) {
  timed_read known = arrived;
  if (!is_device_) {
    known.silence_ns = time_ns_ > 0 ? detail::saturating_sub(arrived.arrival_ns, time_ns_) : 0;
    if (known.silence_ns >= pause_of_file_ns) enter(phase::starts);
  }
  time_ns_ = arrived.arrival_ns;
  known.is_backlog |= known.silence_ns >= arrival_statistics::stall_ns;
  silence_ns_ = std::max(silence_ns_, std::exchange(known.silence_ns, 0));
  if (phase_ == phase::runs) measured_.take(known);
  splitter_.take(data, arrived.arrival_ns, to_);
  if (phase_ != phase::rests) follow_samples(data);
  look();
}

void running_scan::follow_samples(bytes data) {
  if (!sizes_) return;
  sizes_->take(data);
  const stream_samples seen = sizes_->other();
  if (sizes_->is_settled()) sizes_.reset();
  const auto fitting =
      seen.bytes == 0
          ? std::vector<const model*>()
          : models_that_fit(
                {.sample_bytes = seen.bytes,
                 .sample_rate_hz = seen.rate_hz,
                 .frequency_chz = seen.frequency_chz,
                 .answers = which_->link == link_kind::two_way ? presence::yes : presence::no});
  if (fitting.empty()) return;
  read_as(*fitting.front());
  splitter_ = event_splitter(which_->samples);
  garbage_ = 0;
  enter(phase::starts);
}

void running_scan::take(const observed_event& found) {
  const bool is_garbage = std::holds_alternative<skipped>(found.what);
  garbage_ = is_garbage ? garbage_ + found.raw.size() : 0;
  if (const auto* response = std::get_if<response_view>(&found.what)) take(*response);
  if (phase_ == phase::rests) return;
  may_have_booted_ |= std::exchange(boots_, splitter_.boots()) != splitter_.boots();
  if (std::holds_alternative<packet_view>(found.what)) {
    packet_ns_ = found.arrival_ns;
    may_have_booted_ = false;
    const std::int64_t silence_ns = std::exchange(silence_ns_, 0);
    // A scan that ends is silent, too: a stall is a silence with packets behind it.
    if (phase_ == phase::runs && silence_ns > 0)
      measured_.take(timed_read{0, time_ns_, silence_ns});
    if (phase_ == phase::starts) enter(phase::speeds_up);
  }
  if (phase_ >= phase::speeds_up) measured_.take(found);
}

// What a byte means depends on the command; a device that introduces itself without one has booted.
void running_scan::take(const response_view& response) {
  known_.take(response);
  const bool is_frequency = response.as_frequency_chz() && !which_->samples.has_angle_replies;
  if (is_frequency || asked_) {
    known_.take_setting(is_frequency ? command::frequency_query : *asked_, response, *which_);
  }
  const bool is_unasked = is_device_ && asked_ == command::start;
  may_have_booted_ |= is_unasked && response.kind() == response_kind::device_info;
  if (response.kind() == response_kind::scan_started && phase_ != phase::rests &&
      !is_current(time_ns_)) {
    enter(phase::starts);
  }
}

void running_scan::look() {
  if (phase_ < phase::speeds_up) return;
  if (measured_.tally().samples >= looked_ + steady_samples) {
    looked_ = measured_.tally().samples;
    const bool is_steady = measured_.is_steady();
    if (phase_ == phase::speeds_up && is_steady) return enter(phase::runs);
  }
  if (phase_ == phase::speeds_up) {
    if (time_ns_ >= detail::saturating_add(begin_.phase_ns, spin_up_ns)) enter(phase::runs);
    return;
  }
  if (time_ns_ < detail::saturating_add(begin_.stretch_ns, half_window_ns_)) return;
  earlier_ = measured_.next_stretch();
  looked_ = 0;
  begin_.window_ns = std::exchange(begin_.stretch_ns, time_ns_);
}

stream_statistics running_scan::window() const {
  stream_statistics all = measured_;
  all.add(earlier_);
  return all;
}

}  // namespace g4lidar
