// SPDX-License-Identifier: MIT
#include "live_source.hpp"

#include <cerrno>
#include <chrono>
#include <new>
#include <utility>

#include "driver/outcome_error.hpp"
#include "transport/tcp_port.hpp"

namespace g4lidar {
namespace {

bool may_answer(const lidar_options& options) noexcept {
  return !options.listen_only && options.model->link == link_kind::two_way;
}

}  // namespace

live_source::live_source(parts& used, const lidar_options& options)
    : scan_source(used, options),
      options_(options),
      stream_({connection_, pipeline_, receiver_, spin_up_, stage_, takes_points_}, options) {}

result<void> live_source::open() {
  if (auto opened = connect(); !opened) return break_off(opened.error());
  return settle();
}

result<void> live_source::connect() {
  if (auto opened = connection_.open(); !opened) return opened;
  stream_.begin();
  stage_ = live_stage::identifying;
  return connected();
}

result<void> live_source::advance(std::int64_t deadline_ns) {
  switch (stage_) {
    case live_stage::closed:
      return tl::unexpected(reconnection_.why());
    case live_stage::lost:
      if (!reconnection_.wait(connection_, deadline_ns)) return {};
      if (auto opened = connect(); !opened) return break_off(opened.error());
      return {};
    case live_stage::breaking:
      if (stream_.parse()) return {};
      pipeline_.end();
      stage_ = live_stage::broken;
      return {};
    case live_stage::broken:
      if (pipeline_.has_scan()) return {};
      return hang_up();
    default:
      break;
  }
  if (auto done = round(deadline_ns); !done) return break_off(done.error());
  judge_model();
  if (const auto why = std::exchange(refused_, std::nullopt)) return tl::unexpected(*why);
  return {};
}

result<void> live_source::break_off(const error& broken) {
  reconnection_.lost(stream_.error_after(broken));
  leave();
  static_cast<void>(stream_.set_motor(false));
  if (stage_ <= live_stage::identifying) return hang_up();
  stream_.cut();
  stage_ = live_stage::breaking;
  return {};
}

/// Returns an error if waiting calls must know of it: not for a failed attempt to reconnect.
result<void> live_source::hang_up() {
  const bool was_up = stage_ == live_stage::broken;
  if (!was_up) stream_.flush();
  connection_.close();
  if (was_up) {
    report(lidar_event::kind::lost, reconnection_.why().code());
    reconnection_.begin();
  }
  if (!options_.reconnect || !is_recognised_) {
    stage_ = live_stage::closed;
    return tl::unexpected(reconnection_.why());
  }
  stage_ = live_stage::lost;
  connection_.watch();
  reconnection_.plan(now_ns(), std::chrono::nanoseconds(options_.tuning.longest_backoff).count());
  if (was_up) return tl::unexpected(reconnection_.reconnecting());
  return {};
}

void live_source::release(bool rests) noexcept {
  if (rests) static_cast<void>(stream_.set_motor(false));
  if (!rests && connection_.is_open()) connection_.port().keep_dtr();
  stream_.flush();
  pipeline_.drop_scan();
  connection_.close();
  stage_ = live_stage::closed;
  reconnection_.lost(error(task::reading, problem::gone, "this lidar, which was closed"));
}

result<void> live_source::settle() {
  if (stage_ == live_stage::lost) {
    if (auto tried = step(now_ns()); !tried) return tried;
  }
  if (stage_ == live_stage::closed) return tl::unexpected(reconnection_.why());
  while (stage_ != live_stage::lost && (stage_ >= live_stage::breaking || has_work())) {
    // A scan may be complete before the start is done: try_scan() returns it.
    const bool keeps = stage_ == live_stage::preparing && stream_.talk().is_scanning();
    if (!keeps) pipeline_.drop_scan();
    if (auto done = step(never_ns); !done) return done;
  }
  if (stage_ == live_stage::lost) return tl::unexpected(reconnection_.reconnecting());
  return {};
}

result<void> live_source::identified(const device_information& who) {
  const auto other = other_device_error(who, *options_.model, connection_.name());
  if (other && refuses(who)) return tl::unexpected(*other);
  recognised_.set_device(who.model, known_baud());
  if (other) report(lidar_event::kind::other_number);
  // A one-way lidar may state its number before its serial number.
  const bool is_part = options_.model->link == link_kind::one_way &&
                       !(who.has_serial_number() && information_.has_serial_number());
  if (information_.is_known() && !is_part && who.serial_digits != information_.serial_digits) {
    connection_.port_connector().refuse();  // the wanted lidar may be behind another port
    if (reconnection_.refuse(who)) report(lidar_event::kind::other_lidar);
    return failure(task::finding, problem::no_port, connection_.name());
  }
  const auto serial_digits = information_.serial_digits;
  const bool keeps_serial = is_part && information_.has_serial_number();
  information_ = who;
  if (keeps_serial) information_.serial_digits = serial_digits;
  return {};
}

/// Of the line; 0: behind a bridge, where nobody has named it.
std::uint32_t live_source::known_baud() const noexcept {
  return is_bridge(connection_.name()) ? options_.baud : connection_.port().baud();
}

/// Whether the number of another model ends it: nothing that the device will send can decide. A model that was stated is
/// right where the samples of the other one have another size, or its line another rate. What was recognised by its
/// samples has another number anyhow.
bool live_source::refuses(const device_information& who) const noexcept {
  const known_by by = recognised_.get().by;
  const bool is_guessed =
      by == known_by::samples ||
      (by == known_by::nothing && connection_.port_connector().traits().is_searched);
  if (options_.insist_on_model || is_guessed) return false;
  return is_surely_another(*options_.model, who.model, connection_.port().baud());
}

/// The samples have another size than those of the model: they decide, unless the user does.
result<void> live_source::follow_samples() {
  const bool is_other = pipeline_.input().has_other_size();
  if (!std::exchange(recognised_.live.is_held, is_other) && is_other)
    stream_.record(recorded_event::kind::held);
  const stream_samples seen = pipeline_.input().other();
  if (seen.bytes == 0) return {};
  try {
    const model* const found = recognised_.is_stated()
                                   ? nullptr
                                   : recognised_.follow(seen, known_baud(), may_answer(options_));
    if (found == nullptr)
      return tl::unexpected(other_samples_error(seen.bytes, *options_.model, connection_.name()));
    options_.model = found;
    stream_.become(*found);
    recognised_.live.is_judged = false;
  } catch (const std::bad_alloc&) {
    return failure(task::reading, problem::system, connection_.name(), ENOMEM);
  }
  report(lidar_event::kind::other_number);
  return {};
}

/// Once for each start, when the model is stated, or the packets have shown that they are of it: what is reported before is
/// wrong where it becomes another one.
void live_source::judge_model() noexcept {
  if (stage_ != live_stage::scanning) {
    recognised_.live.is_judged = false;
    return;
  }
  const bool is_known = recognised_.is_stated() || pipeline_.input().is_as_expected();
  if (!recognised_.live.is_judged && is_known) {
    recognised_.live.is_judged = true;
    recognised_.confirm(known_baud(), may_answer(options_));
    recognised_.record(connection_.port_connector());
    if (pipeline_.decoder().lacks_zero()) report(lidar_event::kind::no_zero_angle);
  }
}

result<void> live_source::can_read() const noexcept {
  if (stage_ == live_stage::closed) return tl::unexpected(reconnection_.why());
  if (wants_scan_) return {};
  return failure(task::reading, problem::not_scanning, connection_.name());
}

/// A lidar that is lost or being set up sends no scan. Both end by themselves, the setup by the times
/// of its requests.
scan_expectation live_source::expects() const noexcept {
  if (stage_ == live_stage::closed || !wants_scan_) return {};
  if (stream_.is_scanning()) {
    const error_detail why = why_not_yet(pipeline_, now_ns());
    if (!spin_up_.lasts(pipeline_.counts().scans)) return {0, why};
    const bool is_slow = why == error_detail::no_revolution && now_ns() >= spin_up_.ends_ns();
    return {spin_up_.ends_ns(), is_slow ? why : error_detail::spinning_up};
  }
  const bool is_set_up = stage_ == live_stage::preparing || stage_ == live_stage::scanning;
  if (is_set_up && !reconnection_.is_under_way()) return {never_ns, error_detail::spinning_up};
  return {never_ns, error_detail::searching, reconnection_.why().subject()};
}

std::int64_t live_source::next_deadline_ns() const noexcept {
  if (stage_ == live_stage::closed) return never_ns;
  if (stage_ == live_stage::lost) return reconnection_.next_attempt_ns();
  return stage_ >= live_stage::breaking ? now_ns() : due_ns();
}

}  // namespace g4lidar
