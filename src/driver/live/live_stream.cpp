// SPDX-License-Identifier: MIT
#include "live_stream.hpp"

#include <chrono>
#include <variant>

#include "g4lidar/detail/saturating.hpp"
#include "transport/port_holder.hpp"

namespace g4lidar {
namespace {

session_times times_for(const lidar_tuning& tuning) noexcept {
  session_times times;
  times.answer_ns = std::chrono::nanoseconds(tuning.answer_time).count();
  times.stall_ns = std::chrono::nanoseconds(tuning.stall_time).count();
  return times;
}

}  // namespace

live_stream::live_stream(const parts& used, const lidar_options& options)
    : parts_(used),
      pace_(options.tuning.pace),
      link_(used.pipeline.input(), nullptr, times_for(options.tuning),
            device_link::usual_cut_off_ns, *options.model, options.listen_only),
      motor_(options.model->motor),
      leaves_dtr_(options.leave_dtr),
      reported_(*options.model, link_.listens()),
      sample_rate_hz_(first_rate_hz(*options.model)) {}

void live_stream::begin() {
  transport& port = parts_.connection.port();
  link_.follow(port);
  reported_.reset();
  heard_ = {};
  changes_ = {};
  parts_.receiver.reset(port.baud(), port.kept_bytes(), now_ns());
  parts_.pipeline.follow(port.baud());
  parts_.motor.forget();
  is_line_high_ = true;  // the system raises it
  record(recorded_event::kind::held);
}

result<void> live_stream::send() {
  return link_.send([&](bytes command) {
    parts_.pipeline.sent(command);
    heard_.sent(command);
    return parts_.connection.send(command);
  });
}

result<void> live_stream::look_if_due() {
  const std::int64_t due_ns = talk().next_look_ns();
  const event_reader& input = parts_.pipeline.input();
  if (!input.unparsed().empty() || due_ns > now_ns()) return {};
  if (parts_.receiver.read_until_ns() < due_ns) {
    if (auto got = receive(now_ns()); !got) return got;
    if (!input.unparsed().empty()) return {};
  } else if (link_.cut_off()) {
    record(recorded_event::kind::cut);
  }
  if (!input.is_empty() && input.current() == nullptr) {  // cut off
    parts_.pipeline.drop_scan();
    if (parse()) return {};  // look() follows in the next round
  }
  talk().look(now_ns());
  return {};
}

result<void> live_stream::receive(std::int64_t deadline_ns) {
  const auto got = link_.receive(parts_.receiver.buffer(), [&](transport& port) {
    const event_reader& input = parts_.pipeline.input();
    return parts_.receiver.receive(port, how_to_read(), input.held(), input.missing(), deadline_ns);
  });
  if (!got) return tl::unexpected(got.error());
  const bytes data = parts_.receiver.buffer().first(got->count);
  heard_.received(data);
  if (parts_.stage == live_stage::identifying) changes_.take(data);
  if (got->count == 0 && link_.cut_off()) record(recorded_event::kind::cut);
  return {};
}

reading live_stream::how_to_read() const noexcept {
  if (parts_.stage != live_stage::scanning) return reading::at_once;
  if (parts_.receiver.is_batched()) return reading::batched;
  if (link_.awaits_answer()) return reading::at_once;
  const bool by_packets = pace_ == read_pace::automatic
                              ? parts_.takes_points.load(std::memory_order_relaxed)
                              : pace_ == read_pace::packets;
  return by_packets ? reading::paced : reading::scans;
}

bool live_stream::parse() {
  point_pipeline& pipeline = parts_.pipeline;
  const auto next = [&] { return pipeline.find_scan() ? nullptr : pipeline.next(); };
  link_.events(next, [&](const event& found) {
    reported_.take(found);
    follow_delivery();
    const auto* const packet = std::get_if<packet_view>(&found);
    if (packet == nullptr || !pipeline.delivers()) return;
    const double period_ns = pipeline.decoder().period_ns();
    const auto way_ns = static_cast<double>(packet->sample_count() - 1) * period_ns;
    parts_.receiver.packet(*packet, pipeline.input().unparsed().size(),
                           pipeline.decoder().next_sample_ns() + static_cast<std::int64_t>(way_ns),
                           period_ns);
  });
  return pipeline.has_scan();
}

void live_stream::cut() {
  record(recorded_event::kind::cut);
  parts_.pipeline.input().cut();
}

void live_stream::flush() {
  if (!parts_.connection.is_open()) return;
  parts_.pipeline.drop_scan();
  cut();
  while (parse()) parts_.pipeline.drop_scan();
}

void live_stream::follow_delivery() {
  const bool delivers = parts_.pipeline.delivers();
  const bool may_begin =
      parts_.stage >= live_stage::preparing && parts_.stage != live_stage::stopping;
  const bool goes_on = parts_.stage == live_stage::stopping && delivers;
  const bool wanted = link_.listens() ? parts_.stage == live_stage::scanning
                                      : talk().is_scanning() && (may_begin || goes_on);
  if (wanted == delivers) return;
  parts_.pipeline.deliver(wanted);
  wanted ? begin_points() : record(recorded_event::kind::held);
}

void live_stream::begin_points() {
  parts_.motor.begin(detail::saturating_add(now_ns(), spin_up::longest_ns),
                     parts_.pipeline.counts().scans);
  parts_.pipeline.begin(sample_rate_hz_);
  record(recorded_event::kind::begun);
}

result<void> live_stream::set_motor(bool on) {
  constexpr std::int64_t low_ns = 100'000'000;
  const bool has_line = motor_ == motor_kind::dtr && !leaves_dtr_;
  if (!has_line || !parts_.connection.is_open() || (!on && !is_line_high_)) return {};
  const auto set = parts_.connection.port().set_dtr(on);
  if (!set) return tl::unexpected(set.error());
  if (!*set) return {};  // no such line: the motor turns by other means
  is_line_high_ = on;
  if (!on) motor_ready_ns_ = now_ns() + low_ns;
  record(on ? recorded_event::kind::dtr_high : recorded_event::kind::dtr_low);
  return {};
}

void live_stream::become(const model& model) {
  record(recorded_event::kind::cut);  // what is held of a packet is dropped
  talk().reset(&model, true);
  reported_ = identity_reader(model, link_.listens());
  motor_ = model.motor;
  sample_rate_hz_ = first_rate_hz(model);
  parts_.receiver.become(model);
  parts_.receiver.reset(parts_.connection.port().baud(), parts_.connection.port().kept_bytes(),
                        now_ns());
  parts_.pipeline.become(model, parts_.connection.port().baud());
  record(recorded_event::kind::begun);
}

void live_stream::learn(const answer& heard) {
  const auto* rate = std::get_if<sample_rate>(&heard);
  if (rate == nullptr || to_hz(*rate) == sample_rate_hz_) return;
  sample_rate_hz_ = to_hz(*rate);
  if (parts_.pipeline.delivers()) begin_points();
}

/// For a recording. A place is defined by the unparsed rest of the last read and by the number of
/// events from it: both are the same when the same bytes are read again.
void live_stream::record(recorded_event::kind what) {
  recording_hook* const recorder = recording_hook_of(parts_.connection.port_connector());
  if (recorder == nullptr || !parts_.connection.is_open()) return;
  recorded_event made{.what = what, .time_ns = now_ns()};
  made.delivers = parts_.pipeline.delivers();
  made.zero = parts_.pipeline.zero().angle();
  made.baud = parts_.connection.port().baud();
  made.sample_rate_hz = sample_rate_hz_;
  made.unparsed = static_cast<std::uint32_t>(parts_.pipeline.input().unparsed().size());
  made.events = parts_.pipeline.input().events_of_reading();
  recorder->event(made);
}

std::int64_t live_stream::next_deadline_ns() const noexcept {
  if (!parts_.pipeline.is_empty() || !talk().has_nothing()) return now_ns();
  return link_.due_ns();
}

/// An event loop that takes points is woken by each byte. What an idle one-way lidar sends is not read.
std::int64_t live_stream::rest_until_ns() const noexcept {
  if (link_.listens() && parts_.stage == live_stage::idle) return never_ns;
  const reading how = how_to_read();
  if (how != reading::scans && how != reading::batched) return 0;
  const event_reader& input = parts_.pipeline.input();
  return parts_.receiver.again_ns(how, input.held(), input.missing());
}

error live_stream::error_after(const error& why) const {
  return parts_.connection.is_open() ? with_port_conflict(why, parts_.connection.port()) : why;
}

}  // namespace g4lidar
