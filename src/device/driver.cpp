// SPDX-License-Identifier: MIT
// The driver's rounds: bytes in, events taken, time passed, commands out.
#include "driver.hpp"
#include "subject.hpp"

#include <algorithm>
#include <utility>

namespace g4lidar {
namespace {

constexpr std::int64_t ms = 1'000'000;
/// A deadline that has passed.
constexpr std::int64_t at_once = 0;
constexpr std::size_t buffer_size = 65536;
/// A command of two bytes that does not go out in this time never will.
constexpr std::int64_t write_time_ns = 100 * ms;
/// A line that has been silent for so long will not end the frame that it began. Bridges hold bytes
/// back for up to 16 ms.
constexpr std::int64_t frame_pause_ns = 30 * ms;

session_times times_for(const lidar_options& options) noexcept {
  session_times times;
  times.answer_ns = std::chrono::nanoseconds(options.answer_time).count();
  times.stall_ns = std::chrono::nanoseconds(options.stall_time).count();
  return times;
}

}  // namespace

lidar::driver::driver(std::unique_ptr<connector> connector, const lidar_options& options)
    : options_(options),
      connector_(std::move(connector)),
      session_(times_for(options)),
      stream_(options.transport_delay.count(), options.partial_scans),
      buffer_(buffer_size),
      reader_(stream_.ring().make_reader()),
      points_(buffer_size / 8) {}

lidar::driver::~driver() { static_cast<void>(close()); }

// ---- the line -----------------------------------------------------------------------------------

/// A command of which a part had gone out would be worse than one that came late: a wake-up does not
/// stop it.
result<void> lidar::driver::send(bytes command) {
  while (true) {
    auto sent = line_->write(command, now_ns() + write_time_ns);
    if (sent || sent.error().what() != problem::cancelled) return sent;
  }
}

result<void> lidar::driver::send_commands() {
  while (const auto command = session_.to_send()) {
    if (auto sent = send(*command); !sent) return sent;
  }
  return {};
}

/// When a reading is worth its system calls; what comes before that is not waited for.
std::int64_t lidar::driver::read_again_ns() const noexcept {
  if (stage_ != stage::scanning) return 0;
  if (is_batched()) return read_until_ns_ + std::chrono::nanoseconds(options_.batch).count();
  if (is_waiting_for_answer()) return 0;
  return pace_.next_ns(parser_.held(), parser_.missing());
}

/// Waits until a reading is worth it, then for bytes. After a wait they are there, most often, and to
/// look for them first would be one call more.
result<received> lidar::driver::read(std::int64_t deadline_ns) {
  const std::int64_t until = std::min(read_again_ns(), deadline_ns);
  if (until > now_ns()) {
    const auto paused = line_->pause(until);
    const bool is_woken = !paused && paused.error().what() == problem::cancelled;
    if (paused || is_woken) {  // a line that broke off is read to its end, as any other
      const auto got = line_->read(buffer_, at_once);
      if (is_woken || is_batched() || until == deadline_ns || !got || got->count > 0) return got;
      pace_.in_vain();
    }
  }
  return line_->read(buffer_, is_batched() ? at_once : deadline_ns);
}

/// One reading, which waits until something comes or the deadline.
result<void> lidar::driver::receive(std::int64_t deadline_ns) {
  auto got = read(deadline_ns);
  const auto is_woken = [&] { return !got && got.error().what() == problem::cancelled; };
  // Who is woken before each call must get on, too: what is there is taken.
  if (is_woken()) got = line_->read(buffer_, at_once);
  if (is_woken()) return {};  // step() knows
  if (!got) {
    play_notes(true);
    return tl::unexpected(got.error());
  }
  read_until_ns_ = got->count == 0 ? now_ns() : got->arrival_ns;
  if (got->count == 0) return {};
  input_ = bytes(buffer_).first(got->count);
  arrival_ns_ = last_bytes_ns_ = got->arrival_ns;
  events_of_reading_ = 0;
  pace_.came(got->count, got->arrival_ns);
  return {};
}

// ---- one round ----------------------------------------------------------------------------------

/// Does everything that is due, and waits for bytes until the deadline at most once. Stops at a scan.
/// Who is woken has still got on: calls that are woken again and again come to their end.
result<void> lidar::driver::step(std::int64_t deadline_ns) {
  if (stage_ == stage::closed) return tl::unexpected(lost_);
  const std::int64_t until = woken_.load(std::memory_order_relaxed) ? now_ns() : deadline_ns;
  auto done = stage_ == stage::lost ? wait_for_line(until) : round(until);
  if (!done && stage_ != stage::closed) done = hang_up(done.error());
  if (done && refused_) done = tl::unexpected(*std::exchange(refused_, std::nullopt));
  if (done && woken_.load(std::memory_order_relaxed) && woken_.exchange(false)) {
    return failure(task::reading, problem::cancelled, name());
  }
  return done;
}

result<void> lidar::driver::round(std::int64_t deadline_ns) {
  static_cast<void>(is_delivering());
  if (line_->answers()) {
    if (auto looked = look_if_due(); !looked) return looked;
  }
  if (auto served = serve(); !served) return served;
  if (digest()) return {};
  if (input_.empty()) {
    // Whoever waits for an outcome wants to know of it first.
    const bool hurry = std::exchange(has_outcome_, false);
    const std::int64_t until = hurry ? now_ns() : std::min(deadline_ns, next_deadline_ns());
    if (auto got = receive(until); !got) return got;
    if (input_.empty()) end_a_silent_frame();
  }
  if (digest()) return {};
  // An event loop may not come back before something is heard: nothing is left to be said.
  auto served = serve();
  has_outcome_ = false;
  return served;
}

/// What follows from what was heard: notices, the next of the plan, commands.
result<void> lidar::driver::serve() {
  if (session_.has_nothing() && plan_at_ == planned_) return {};  // as most of the time
  if (!line_->answers()) return {};
  if (auto told = take_notice(); !told) return told;
  if (auto gone_on = go_on_with_plan(); !gone_on) return gone_on;
  return send_commands();
}

/// Lets the time pass for the session, when it is due. What had come by then and was not read, since
/// the program slept, is taken in before that.
result<void> lidar::driver::look_if_due() {
  const std::int64_t due_ns = session_.next_look_ns();
  if (!input_.empty() || due_ns > now_ns()) return {};
  if (read_until_ns_ < due_ns) {
    if (auto got = receive(now_ns()); !got) return got;
    if (!input_.empty()) return {};
  }
  end_a_silent_frame();
  session_.look(now_ns());
  return {};
}

/// The device will not go on with a frame after such a pause, so what is held is taken apart before
/// the next answer is taken for its end.
void lidar::driver::end_a_silent_frame() {
  if (!is_waiting_for_answer() || parser_.held() == 0) return;
  if (now_ns() - last_bytes_ns_ >= frame_pause_ns) cut_off();  // the input is empty
}

bool lidar::driver::is_waiting_for_answer() const noexcept {
  return !is_replay_ && (session_.is_busy() || !session_.is_scanning());
}

void lidar::driver::cut_off() {
  note(line_note::kind::cut);
  input_ = {};
  end_of_bytes();
}

void lidar::driver::end_of_bytes() {
  while (const auto found = parser_.finish()) take(*found);
  while (stream_.has_more()) keep_scan();
}

/// Parses until a scan is complete, which is then in `scan_`: true; or until nothing is left.
bool lidar::driver::digest() {
  if (scan_) return true;
  while (!keep_scan()) {
    play_notes(false);
    const std::size_t before = input_.size();
    const auto found = parser_.next(input_);
    bytes_ += before - input_.size();
    if (!found) {
      if (before > 0 && delivers_) stream_.seen(parser_.held(), arrival_ns_);
      play_notes(true);
      return scan_.has_value();
    }
    take(*found);
  }
  return true;
}

bool lidar::driver::keep_scan() {
  if (!stream_.has_more()) return false;
  if (scan_) ++scans_missed_;
  scan_ = stream_.next_scan();
  return scan_.has_value();
}

void lidar::driver::take(const event& found) {
  stream_counts_.add(found);
  if (line_ == nullptr || line_->answers()) session_.take(found, arrival_ns_);
  play_notes(false);
  const bool is_delivered = is_delivering();
  ++events_of_reading_;
  if (!is_delivered) return;
  if (const auto* packet = std::get_if<packet_view>(&found)) {
    drop_scan();  // at the end of the bytes one may still wait, where the points of this go
    stream_.packet(*packet, arrival_ns_, input_.size());
    pace_.packet(*packet, input_.size(), stream_.period_ns());
  } else if (const auto* gone = std::get_if<skipped>(&found)) {
    stream_.gone(*gone);
  }
}

/// A scan that goes on after a break, for whatever reason, begins anew.
bool lidar::driver::is_delivering() {
  const bool was_delivering = std::exchange(delivers_, delivers_points());
  if (delivers_ && !was_delivering) begin_points();
  if (!delivers_ && was_delivering) note(line_note::kind::held);
  return delivers_;
}

void lidar::driver::begin_points() {
  stream_.begin(samples_per_second_);
  note(line_note::kind::begun);
}

/// Packets of a device that is being stopped are nobody's.
bool lidar::driver::delivers_points() const noexcept {
  if (line_ != nullptr && !line_->answers()) return stage_ == stage::scanning && is_played_;
  return stage_ >= stage::preparing && session_.is_scanning();
}

result<void> lidar::driver::take_notice() {
  has_streamed_ = has_streamed_ || stream_.has_begun();
  switch (session_.noticed()) {
    case notice::none:
      return {};
    case notice::found_scanning:
      tell(lidar_event::kind::found_scanning);
      return {};
    case notice::protection_starved:
      tell(lidar_event::kind::protection_starved);
      break;
    case notice::protection_found_on:
      tell(lidar_event::kind::protection_found_on);
      if (!set_up_again()) return tl::unexpected(fallen_silent());
      break;
    case notice::restarted:
      tell(lidar_event::kind::restarted);
      if (!set_up_again()) return tl::unexpected(fallen_silent());
      break;
    case notice::stalled:
      return tl::unexpected(fallen_silent());
  }
  begin_points();
  return {};
}

std::int64_t lidar::driver::next_deadline_ns() const noexcept {
  if (stage_ == stage::closed) return never_ns;
  if (stage_ == stage::lost) return next_attempt_ns_;
  if (scan_ || !input_.empty() || stream_.has_more()) return now_ns();
  if (line_->answers() && !session_.has_nothing()) return now_ns();
  std::int64_t next = line_->answers() ? session_.next_look_ns() : never_ns;
  if (is_waiting_for_answer() && parser_.held() > 0) {
    next = std::min(next, last_bytes_ns_ + frame_pause_ns);
  }
  return next;
}

// ---- what it is asked ---------------------------------------------------------------------------

result<void> lidar::driver::open() {
  if (auto connected = connect(); !connected) return connected;
  return run_plan();
}

result<void> lidar::driver::start() {
  if (stage_ == stage::scanning && wants_scan_) return {};
  if (auto ready = run_plan(); !ready) return ready;
  const bool scans = !line_->answers() || session_.is_scanning();  // or a stop was woken
  if (stage_ == stage::scanning && scans) {  // a start that was woken, and has now come to its end
    wants_scan_ = true;
    return {};
  }
  if (!line_->answers()) {
    stage_ = stage::scanning;
    wants_scan_ = true;
    return {};
  }
  scan_.reset();
  wants_scan_ = true;
  plan_start();
  const auto started = run_plan();
  // One that is woken goes on in the calls that follow, be they next_scan().
  if (!started && started.error().what() != problem::cancelled) wants_scan_ = false;
  return started;
}

result<void> lidar::driver::stop() {
  wants_scan_ = false;
  if (stage_ == stage::lost) return {};  // it is stopped when it is found again
  if (auto ready = run_plan(); !ready) return ready;
  scan_.reset();
  if (line_->answers()) {
    // A stop that was woken has gone on meanwhile.
    if (!std::exchange(stops_, true)) plan(requests::stop(), true);
    if (auto stopped = run_plan(); !stopped) return stopped;
    stops_ = false;
  }
  cut_off();
  scan_.reset();
  stream_.end();
  stage_ = stage::idle;
  return {};
}

result<void> lidar::driver::close() {
  result<void> stopped;
  while (stage_ == stage::scanning || stage_ == stage::preparing) {
    stopped = stop();
    if (stopped || stopped.error().what() != problem::cancelled) break;
  }
  release();
  return stopped;
}

void lidar::driver::release() noexcept {
  if (line_ != nullptr) release_line();
  stage_ = stage::closed;
  lost_ = error(task::reading, problem::gone, "this lidar, which was closed");
}

result<answer> lidar::driver::ask(const request& wanted, while_scanning how) {
  const bool goes_on = woken_question_ == wanted && session_.is_busy();
  woken_question_.reset();
  if (!goes_on) {
    if (auto begun = begin_question(wanted, how); !begun) return tl::unexpected(begun.error());
  }
  asked_.reset();
  asking_ = true;
  auto done = result<void>();
  while (done && line_ != nullptr && !asked_) {
    drop_scan();
    done = step(never_ns);
  }
  asking_ = false;
  const bool is_woken = !done && done.error().what() == problem::cancelled;
  if (is_woken && asked_) {
    woken_.store(true);  // for the next call: this one has got its answer
  } else if (!done || !asked_) {
    if (is_woken) woken_question_ = wanted;
    return tl::unexpected(done ? lost_ : done.error());
  }
  if (asked_->how != verdict::answered) return tl::unexpected(error_of(*asked_));
  if (plan_at_ < planned_) {  // behind a restart
    const auto ready = run_plan();
    if (!ready && ready.error().what() != problem::cancelled) return tl::unexpected(ready.error());
    if (!ready) woken_.store(true);  // it goes on in the next call
  }
  return asked_->value;
}

result<void> lidar::driver::begin_question(const request& wanted, while_scanning how) {
  if (auto ready = run_plan(); !ready) return ready;
  if (!line_->answers()) return failure(task::asking, problem::read_only, name());
  if (session_.begin(wanted, now_ns(), how)) {
    return failure(task::asking, problem::scanning, subject(name()).add(wanted));
  }
  return {};
}

result<scan> lidar::driver::next_scan(std::int64_t timeout_ns) {
  if (auto able = can_read(); !able) return tl::unexpected(able.error());
  const std::int64_t deadline_ns = now_ns() + timeout_ns;
  bool last = false;
  while (!scan_) {
    if (last) return failure(task::reading, problem::timeout, name());
    if (auto done = step(deadline_ns); !done) return tl::unexpected(done.error());
    last = now_ns() >= deadline_ns && input_.empty() && !stream_.has_more();
  }
  const scan found = *scan_;
  scan_.reset();
  return found;
}

result<std::span<const point>> lidar::driver::next_points(std::int64_t timeout_ns) {
  if (auto able = can_read(); !able) return tl::unexpected(able.error());
  const std::int64_t deadline_ns = now_ns() + timeout_ns;
  bool last = false;
  while (true) {
    const ring_read read = reader_.read(points_);
    points_missed_ += read.missed;
    if (read.points > 0) return std::span<const point>(points_).first(read.points);
    if (last) return failure(task::reading, problem::timeout, name());
    drop_scan();
    if (auto done = step(deadline_ns); !done) return tl::unexpected(done.error());
    last = now_ns() >= deadline_ns && input_.empty() && !stream_.has_more();
  }
}

result<void> lidar::driver::process() {
  drop_scan();
  return step(now_ns());
}

result<void> lidar::driver::can_read() const noexcept {
  if (stage_ == stage::closed) return tl::unexpected(lost_);
  if (!wants_scan_) return failure(task::reading, problem::not_scanning, name());
  return {};
}

void lidar::driver::drop_scan() noexcept {
  if (!scan_) return;
  ++scans_missed_;
  scan_.reset();
}

// ---- what it tells ------------------------------------------------------------------------------

std::string_view lidar::driver::name() const noexcept {
  return line_ != nullptr ? line_->name() : std::string_view(options_.device);
}

void lidar::driver::tell(lidar_event::kind what, problem reason) noexcept {
  events_.put({what, reason, now_ns()});
}

lidar_counts lidar::driver::counts() const noexcept {
  lidar_counts all;
  all.bytes = bytes_;
  all.held = parser_.held();
  all.stream = stream_counts_;
  all.samples_lost = stream_.samples_lost();
  all.scans = stream_.scans();
  all.partial_scans = stream_.partial_scans();
  all.scans_missed = scans_missed_;
  all.points_missed = points_missed_;
  all.command_retries = session_.retries();
  all.reconnects = reconnects_;
  all.largest_gap_ns = stream_.largest_gap_ns();
  return all;
}

}  // namespace g4lidar
