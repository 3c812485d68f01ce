// SPDX-License-Identifier: MIT
#include "replay_player.hpp"

#include <utility>

#include "driver/error_context.hpp"
#include "g4lidar/recording/contents.hpp"

namespace g4lidar {
namespace {

/// For a recording of raw bytes: how the points that follow are made.
recorded_event event_of(recorded_event::kind what, std::optional<zero_angle> zero,
                        const auto& samples, connection& played) {
  return {.what = what,
          .baud = played.port().baud(),
          .sample_rate_hz = samples.rate_hz,
          .time_ns = played.now_ns(),
          .name = played.name(),
          .zero = zero,
          .counts_times = samples.counts_times};
}

/// Whether the event happened when this much of the read had been processed.
bool is_here(const recorded_event& event, const event_reader& input) noexcept {
  switch (event.what) {
    case recorded_event::kind::begun:
    case recorded_event::kind::held:
    case recorded_event::kind::cut:
      return input.unparsed().size() <= event.unparsed && input.events_of_reading() >= event.events;
    case recorded_event::kind::opened:
    case recorded_event::kind::closed:
    case recorded_event::kind::gap:
      return false;  // after the complete read
    case recorded_event::kind::sent:
    case recorded_event::kind::state:
    case recorded_event::kind::odometry:
    case recorded_event::kind::dtr_low:
    case recorded_event::kind::dtr_high:
      break;
  }
  return true;  // the place does not matter
}

}  // namespace

replay_player::replay_player(parts& used, const lidar_options& options)
    : scan_source(used, options),
      stated_{.identity = identity_reader(*options.model, true)},
      samples_{options.raw_sample_rate_hz.value_or(first_rate_hz(*options.model)),
               options.raw_sample_rate_hz.has_value(),
               options.counts_times || options.raw_sample_rate_hz.has_value()} {}

result<void> replay_player::open() {
  if (auto opened = connection_.open(); !opened) return opened;
  recording_hook* const hook = recording_hook_of(connection_.port_connector());
  file_ = file_of(connection_.port_connector());
  source_ = hook != nullptr ? hook->events() : nullptr;
  if (source_ == nullptr) {
    stated_.recorder = hook;
    source_ = file_;  // the seams of raw bytes in a loop
    const std::uint32_t counted_hz = file_ ? file_->items().source().counted_hz() : 0;
    if (counted_hz > 0) samples_ = {counted_hz, true, true};
  }
  if (file_ != nullptr) file_->controls().when_moved([this] { follow_seek(); });
  receiver_.reset(0, 0, now_ns());
  pipeline_.follow(connection_.port().baud());
  stage_ = stage::idle;
  if (source_ == nullptr) return {};
  information_ = source_->device().information;
  pipeline_.identified(information_);
  if (const auto rate = source_->device().sample_rate) samples_.rate_hz = to_hz(*rate);
  static_cast<void>(parse_bytes());
  return {};
}

result<void> replay_player::start() {
  if (stage_ != stage::idle) return can_read();
  stage_ = stage::playing;
  const auto zero = pipeline_.zero().angle();  // the user knows it
  if (zero || samples_.counts_times) {
    stated_.record(event_of(recorded_event::kind::begun, zero, samples_, connection_));
  }
  spin_up_.forget();
  begin_spin_up();
  return {};
}

result<void> replay_player::stop() {
  if (stage_ == stage::closed) return tl::unexpected(why_);
  pipeline_.drop_scan();
  pipeline_.input().cut();
  while (parse_bytes()) pipeline_.drop_scan();
  static_cast<void>(check());  // a wake-up ends the next call
  pipeline_.end();
  if (stage_ == stage::playing) stage_ = stage::idle;
  return {};
}

result<answer> replay_player::ask(const request& /*wanted*/, while_scanning /*how*/) {
  if (stage_ == stage::closed) return tl::unexpected(why_);
  return failure(task::asking, problem::read_only, connection_.name());
}

void replay_player::release(bool /*rests*/) noexcept {
  if (stage_ != stage::closed) static_cast<void>(stop());
  pipeline_.drop_scan();
  connection_.close();
  stage_ = stage::closed;
  is_released_ = true;
  why_ = error(task::reading, problem::gone, "this lidar, which was closed");
}

result<void> replay_player::can_read() const noexcept {
  if (stage_ == stage::closed) return tl::unexpected(why_);
  if (stage_ != stage::idle) return {};
  return failure(task::reading, problem::not_scanning, connection_.name());
}

/// Where the recorded lidar was lost or stopped, the recording goes on later, or ends.
scan_expectation replay_player::expects() const noexcept {
  if (!is_scanning()) return {};
  const auto why =
      file_ != nullptr ? error_detail::of_file : why_not_yet(pipeline_, now_ns());  // a pipe
  if (!delivers_ || stands()) return {never_ns, why};
  return {spin_up_.lasts(pipeline_.counts().scans) ? spin_up_.ends_ns() : 0, why};
}

result<void> replay_player::advance(std::int64_t deadline_ns) {
  switch (stage_) {
    case stage::closed:
      return tl::unexpected(why_);
    case stage::ended:
      if (pipeline_.has_scan()) return {};
      connection_.close();
      stage_ = stage::closed;
      report(lidar_event::kind::lost, why_.code());
      return tl::unexpected(why_);
    default:
      break;
  }
  follow_delivery();
  const bool has_scan = parse_bytes();
  if (auto good = check(); !good || has_scan) return good;
  if (stage_ == stage::ending) {
    pipeline_.end();
    stage_ = stage::ended;
    return {};
  }
  report_long_pause();
  const reading how = receiver_.is_batched() && is_scanning() ? reading::batched : reading::at_once;
  const auto got = receiver_.receive(connection_.port(), how, pipeline_.input().held(),
                                     pipeline_.input().missing(), deadline_ns);
  if (!got) {
    why_ = got.error();
    pipeline_.input().cut();
    stage_ = stage::ending;
    return {};
  }
  may_have_more_ = got->count > 0;
  if (got->count == 0) return check();
  is_pause_reported_ = false;
  if (const auto command = std::exchange(next_.sent, std::nullopt)) pipeline_.sent(*command);
  pipeline_.input().feed(receiver_.buffer().first(got->count), got->arrival_ns);
  if (!parse_bytes()) follow_samples();
  return check();
}

/// The bytes are read as those of another model if their samples have another size, as the driver did that recorded them.
void replay_player::follow_samples() {
  const stream_samples seen = pipeline_.input().other();
  const recognition now = recognised_.get();
  if (seen.bytes == 0 || now.by == known_by::user) return;
  const std::uint32_t baud = connection_.port().baud();
  const model* const found = recognised_.follow(seen, baud, now.model->link == link_kind::two_way);
  if (found == nullptr) return;
  stated_.follow(*found);
  if (!samples_.is_given) samples_.rate_hz = first_rate_hz(*found);
  pipeline_.become(*found, baud);
  if (samples_.counts_times) pipeline_.begin(samples_.rate_hz, true);
  report(lidar_event::kind::other_number);
}

/// Whether reading the file was not cancelled by then.
result<void> replay_player::check() const noexcept {
  if (source_ == nullptr || !source_->take_cancelled()) return {};
  return failure(task::reading, problem::cancelled, connection_.name());
}

/// Once per pause.
void replay_player::report_long_pause() {
  constexpr std::int64_t long_pause_ns = 60'000'000'000;
  if (source_ == nullptr || is_pause_reported_ || source_->wait_for_next_ns() < long_pause_ns)
    return;
  is_pause_reported_ = true;
  report(lidar_event::kind::long_pause);
}

/// Parses until there is a scan (true), or until nothing is left and all recorded actions before
/// the next read are done.
bool replay_player::parse_bytes() {
  while (!pipeline_.find_scan()) {
    static_cast<void>(play_events(false));
    if (const event* const found = pipeline_.next()) {
      static_cast<void>(play_events(false));
      follow_delivery();
      stated_.identity.take(*found);
      if (stated_.identity.take_news()) {
        const device_information who = stated_.identity.who().value_or(device_information{});
        if (!information_.is_known()) information_ = who;
        const bool is_other = stated_.identity.has_other_number();
        const bool answers = recognised_.get().model->link == link_kind::two_way;  // with all bits
        if (is_other || answers) recognised_.set_device(who.model, 0);
        if (is_other) report(lidar_event::kind::other_number);
      }
      if (const auto zero = pipeline_.zero().angle(); zero != stated_.recorded_zero) {
        stated_.record(event_of(recorded_event::kind::state, zero, samples_, connection_));
      }
      const bool makes_points = pipeline_.delivers() && std::holds_alternative<packet_view>(*found);
      const bool is_first = makes_points && !std::exchange(stated_.is_zero_judged, true);
      if (is_first && pipeline_.decoder().lacks_zero()) report(lidar_event::kind::no_zero_angle);
    } else if (!play_events(true)) {
      return false;
    }
  }
  return true;
}

void replay_player::follow_delivery() {
  const bool ends = stage_ == stage::ending;  // as in the previous call
  const bool wanted = delivers_ && (is_scanning() || (ends && pipeline_.delivers()));
  if (wanted == pipeline_.delivers()) return;
  pipeline_.deliver(wanted);
  if (!wanted) return;
  begin_spin_up();
  pipeline_.begin(samples_.rate_hz, samples_.counts_times);
}

/// Repeats the recorded action of this place, or all actions before the next read. Where an
/// unfinished packet was cut, the resulting events come first. Returns whether anything was done.
bool replay_player::play_events(bool all) {
  bool any = false;
  while (source_ != nullptr) {
    if (!next_.event) next_.event = source_->next_event();
    if (!next_.event || (!all && (next_.is_cut || !is_here(*next_.event, pipeline_.input()))))
      return any;
    const auto what = next_.event->what;
    const bool ends_here = what == recorded_event::kind::cut;
    const bool cuts =
        ends_here || what == recorded_event::kind::closed || what == recorded_event::kind::gap;
    if (cuts && !std::exchange(next_.is_cut, true)) {
      pipeline_.input().cut();
      if (ends_here) {
        next_.is_cut = false;
        next_.event.reset();
      }
      return true;
    }
    next_.is_cut = false;
    play(*next_.event);
    next_.event.reset();
    any = true;
  }
  return any;
}

void replay_player::play(const recorded_event& what) {
  if (what.zero) pipeline_.zero().set(*what.zero, zero_offset::stated_by::recording);
  switch (what.what) {
    case recorded_event::kind::opened:
      pipeline_.follow(what.baud);
      delivers_ = true;  // the driver's first event corrects this
      spin_up_.forget();
      if (!std::exchange(lost_.is_lost, false)) return;
      ++lost_.ended;
      return report(lidar_event::kind::reconnected);
    case recorded_event::kind::closed:
      delivers_ = false;
      if (what.reason == problem::cancelled) return;
      lost_.is_lost = true;
      return report(lidar_event::kind::lost, what.reason);
    case recorded_event::kind::begun:
      follow_samples();  // here the recorded driver did
      delivers_ = what.delivers;
      samples_.rate_hz = what.sample_rate_hz;
      samples_.counts_times = what.counts_times;
      return pipeline_.begin(samples_.rate_hz, samples_.counts_times);
    case recorded_event::kind::held:
      delivers_ = false;
      return;
    case recorded_event::kind::gap:
      return pipeline_.begin(samples_.rate_hz, samples_.counts_times);
    case recorded_event::kind::state:
      break;
    case recorded_event::kind::sent:
      // It is answered in the reads behind it; what is left of the last one answers the command before.
      if (what.data.size() == 2) next_.sent = {what.data[0], what.data[1]};
      return;
    default:
      return;
  }
  // The state, which is repeated regularly in a recording: usually nothing changes.
  pipeline_.follow(what.baud);
  delivers_ = what.delivers;
  const std::uint32_t rate = what.sample_rate_hz;
  const bool counts = what.counts_times;
  if (rate == 0 || (rate == samples_.rate_hz && counts == samples_.counts_times)) return;
  samples_.rate_hz = rate;
  samples_.counts_times = counts;
  pipeline_.begin(rate, counts);
}

/// This depends on the bytes only. What is left to do is due at once, by every clock.
std::int64_t replay_player::next_deadline_ns() const noexcept {
  if (stage_ == stage::closed) return never_ns;
  // What was read of a pipe while it was opened makes its descriptor not readable.
  const bool has_more = source_ == nullptr && stage_ == stage::playing && may_have_more_;
  return has_more || stage_ >= stage::ending || !pipeline_.is_empty() ? 0 : never_ns;
}

player* replay_player::controls() noexcept {
  return file_ == nullptr || is_released_ ? nullptr : &file_->controls();
}

/// The file is at another place: what was read before is dropped.
void replay_player::follow_seek() {
  if (is_released_) return;
  pipeline_.deliver(false);
  pipeline_.input().cut();
  do {
    while (pipeline_.find_scan()) pipeline_.drop_scan();
  } while (pipeline_.next() != nullptr);
  pipeline_.end();
  pipeline_.drop_scan();
  next_.event.reset();
  next_.is_cut = lost_.is_lost = is_pause_reported_ = false;
  delivers_ = true;
  if (!connection_.is_open()) static_cast<void>(connection_.open());
  receiver_.reset(0, 0, now_ns());
  if (connection_.is_open()) pipeline_.follow(connection_.port().baud(), true);
  if (stage_ == stage::idle) return;
  stage_ = connection_.is_open() ? stage::playing : stage::closed;
  spin_up_.forget();
  begin_spin_up();
}

}  // namespace g4lidar
