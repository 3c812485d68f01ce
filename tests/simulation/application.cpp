// SPDX-License-Identifier: MIT
#include "application.hpp"

#include <algorithm>
#include <cstdio>
#include <optional>

#include "g4lidar/core/response.hpp"

namespace g4lidar::simulation {
namespace {

using std::chrono::milliseconds;

/// A call that reads is back so long after its time at the latest: what its own calls cost.
constexpr std::int64_t read_slack_ns = 3 * ms;
/// A request asks nothing after 10 s; what is under way then ends within 5 s.
constexpr std::int64_t request_ns = 15 * second;
/// Between two sleeps all that has come is read, and the keep-alive sent.
constexpr std::int64_t awake_between_ns = 300 * ms;
/// A start makes at most 8 requests, and once more a stop and these.
constexpr std::int64_t start_ns = 17 * request_ns;
constexpr milliseconds timeouts[] = {milliseconds(0),   milliseconds(1),   milliseconds(20),
                                     milliseconds(200), milliseconds(500), milliseconds(2000)};

request some_request(dice& d, bool may_restart) {
  switch (d.between(0, may_restart ? 9 : 8)) {
    case 0:
      return requests::device_info();
    case 1:
      return requests::health();
    case 2:
      return requests::get_low_power();
    case 3:
      return requests::get_scan_frequency();
    case 4:
      return requests::set(scan_frequency{static_cast<std::uint16_t>(d.between(50, 120) * 10)});
    case 5:
      return requests::get_sample_rate();
    case 6:
      return requests::set(*reply_byte<sample_rate>(static_cast<std::uint8_t>(d.between(0, 2))));
    case 7:
      return requests::set(static_cast<constant_frequency>(d.between(0, 1)));
    case 8:
      return requests::step(frequency_step::up_1_hz);
    default:
      return requests::restart();
  }
}

}  // namespace

application::application(const run_parameters& parameters, bool verbose)
    : parameters_(parameters),
      verbose_(verbose),
      dice_(parameters.seed, 0xA99),
      environment_(parameters.device, parameters.faults),
      checker_(parameters, environment_) {
  environment_.on_call = [this] { checker_.look(); };
  environment_.wake = [this] { wake(); };
  environment_.bridge_baud = parameters.bridge_baud;
  environment_.watches = parameters.seed % 2 == 1;
  if (verbose_) std::fputs(describe(parameters_).c_str(), stdout);
}

void application::fail(const std::string& what) {
  if (has_passed()) report_.failed_ns = now();
  checker_.fail(what);
}

/// A call that must be over by then. Gives how long it took.
template <class Call>
std::int64_t application::within(std::int64_t limit_ns, const char* name, Call&& call) {
  const std::int64_t begin_ns = now();
  checker_.app_call();
  call();
  checker_.look();
  const std::int64_t took_ns = now() - begin_ns;
  if (took_ns > limit_ns) {
    fail(std::string(name) + " took " + std::to_string(took_ns / ms) + " ms instead of " +
         std::to_string(limit_ns / ms));
  }
  if (!has_passed() && report_.failed_ns == 0) report_.failed_ns = now();
  print_events();
  print_state();
  return took_ns;
}

/// The application does not act again and again at one time: each act that is refused waits.
void application::check_progress() {
  acts_ = now() - acted_ns_ < ms ? acts_ + 1 : 0;
  if (acts_ == 0) acted_ns_ = now();
  if (acts_ > 3000) fail("the application gets nowhere");
}

void application::print_events() {
  if (!lidar_) return;
  while (const auto event = lidar_->next_event()) {
    ++report_.events[static_cast<std::size_t>(event->what)];
    log(text_of("event %s, %s at %.6f", name_of(event->what).data(), name_of(event->reason).data(),
                in_seconds(event->time_ns)));
    checker_.breaks();
    if (is_usual(parameters_, event->what)) continue;
    if (parameters_.healthy)
      fail("an event in a healthy run: " + std::string(name_of(event->what)));
  }
}

/// Once a second.
void application::print_state() {
  if (!verbose_ || now() / second == printed_s_) return;
  printed_s_ = now() / second;
  const auto asked = environment_.device.log();
  std::string codes;
  for (const sim::asked& a : asked)
    codes += text_of(" %s%02x", a.obeyed ? "" : "!", unsigned{a.code});
  environment_.device.clear_log();
  log(text_of("  device %s%s; lidar %s, %llu revolutions; asked%s",
              environment_.device.is_up() ? "up" : "down",
              environment_.device.is_scanning() ? ", scanning" : "",
              lidar_ && lidar_->is_scanning() ? "scanning" : "idle",
              static_cast<unsigned long long>(checker_.scans()), codes.c_str()));
}

void application::wake() {
  if (!lidar_) return;
  log(text_of("wake"));
  lidar_->wake();
}

void application::sleep_until(std::int64_t until_ns) {
  while (now() < until_ns && has_passed()) {
    environment_.clock.advance_to(std::min(until_ns, now() + 100 * ms));
    static_cast<void>(environment_.device.is_plugged(now()));
    checker_.look();
  }
}

void application::open() {
  result<lidar> made = g4lidar::failure(task::opening, problem::timeout);
  within(request_ns, "open()", [&] {
    made = lidar::open(std::make_unique<observed_connector>(environment_), parameters_.options);
  });
  if (!made) {
    log(text_of("open: %s", made.error().message().c_str()));
    if (parameters_.healthy) fail("a healthy device does not open: " + made.error().message());
    return sleep_until(now() + 200 * ms);
  }
  log("open");
  ++report_.opens;
  lidar_ = std::make_unique<lidar>(std::move(*made));
  taken_ = 0;
  wants_scan_ = false;
  checker_.begin(*lidar_);
}

void application::close(bool politely) {
  if (!lidar_) return;
  log(politely ? "close" : "destroy");
  report_.reconnects += lidar_->counts().reconnects;
  environment_.wake_ns = never_ns;
  report_.longest_stop_ns =
      std::max(report_.longest_stop_ns, within(request_ns, "close()", [&] {
                 if (politely) {
                   const auto closed = lidar_->close();
                   if (!closed) log(text_of("close: %s", closed.error().message().c_str()));
                   if (!closed && now() > parameters_.end_ns)
                     fail("close() failed: " + closed.error().message());
                   checker_.look();
                 }
                 checker_.end();
                 lidar_.reset();
               }));
}

void application::start() {
  result<void> done;
  checker_.is_breaking(true);
  const std::int64_t took_ns = within(start_ns, "start()", [&] { done = lidar_->start(); });
  if (done) checker_.is_breaking(false);
  report_.longest_start_ns = std::max(report_.longest_start_ns, took_ns);
  wants_scan_ = done.has_value();
  if (done) return log(text_of("start took %.3f s", in_seconds(took_ns)));
  log(text_of("start: %s", done.error().message().c_str()));
  if (parameters_.healthy && done.error() != problem::cancelled) {
    fail("a healthy device does not start: " + done.error().message());
  }
  if (done.error().is_fatal() && !parameters_.options.reconnect) close(dice_.chance(0.5));
  sleep_until(now() + 200 * ms);
}

void application::stop() {
  result<void> done;
  checker_.is_breaking(true);
  const std::int64_t took_ns = within(request_ns, "stop()", [&] { done = lidar_->stop(); });
  report_.longest_stop_ns = std::max(report_.longest_stop_ns, took_ns);
  log(text_of("stop: %s", done ? "done" : done.error().message().c_str()));
  wants_scan_ = false;
  if (!done) return judge(done.error());
  if (dice_.chance(0.5))
    sleep_until(std::min(now() + dice_.between(0, second), parameters_.calm_ns));
  if (dice_.chance(0.3)) ask();
}

void application::ask() {
  if (!lidar_) return;
  const bool may_stop = dice_.chance(0.7);
  const request wanted = some_request(dice_, !parameters_.healthy);
  if (may_stop) checker_.is_breaking(true);
  result<answer> got = g4lidar::failure(task::asking, problem::timeout);
  const std::int64_t took_ns = within(request_ns + 5 * second, "ask()", [&] {
    got = lidar_->ask(wanted, may_stop ? while_scanning::stop_and_resume : while_scanning::refuse);
  });
  report_.longest_ask_ns = std::max(report_.longest_ask_ns, took_ns);
  // One that was woken goes on, until the next call has brought it to its end.
  if (got || got.error() != problem::cancelled) checker_.is_breaking(false);
  log(text_of("ask %d: %s after %.3f s", static_cast<int>(wanted.what),
              got ? "answered" : got.error().message().c_str(), in_seconds(took_ns)));
  if (!got) return judge(got.error());
}

/// An error of a call, as an application takes it.
void application::judge(const error& what) {
  const bool is_nothing =
      what == problem::timeout || what == problem::cancelled || what == problem::scanning;
  if (is_nothing) return;
  log(text_of("error: %s", what.message().c_str()));
  if (what == problem::not_scanning) {
    wants_scan_ = false;
  } else if (what.is_fatal()) {
    // With reconnecting the driver goes on by itself, but what was asked is not done.
    if (!parameters_.options.reconnect) close(dice_.chance(0.5));
  }
}

void application::read_scan(milliseconds timeout) {
  within(std::chrono::nanoseconds(timeout).count() + read_slack_ns, "try_scan()", [&] {
    const auto found = lidar_->try_scan(timeout);
    if (!found) return judge(found.error());
    checker_.look();
    checker_.check_scan(*found);
  });
}

void application::read_points(milliseconds timeout) {
  within(std::chrono::nanoseconds(timeout).count() + read_slack_ns, "next_points()", [&] {
    const auto found = lidar_->next_points(timeout);
    if (!found) {
      if (found.error() == problem::timeout) checker_.check_taken(taken_, true);
      return judge(found.error());
    }
    checker_.look();
    taken_ += found->size();
    checker_.check_taken(taken_, false);
    checker_.check_stretch(*found, "next_points()");
  });
}

/// What an event loop does.
void application::process() {
  const std::int64_t due_ns = std::min({lidar_->event_loop().next_deadline_ns(),
                                        environment_.device.next_ns(now()), now() + 200 * ms});
  sleep_until(std::max(now(), due_ns));
  if (dice_.chance(0.3)) return read_scan(milliseconds(0));
  within(read_slack_ns, "process()", [&] {
    const auto done = lidar_->event_loop().process();
    if (!done) judge(done.error());
  });
}

bool application::be_scanning() {
  if (!lidar_) open();
  if (!has_passed() || !lidar_) return false;
  if (!wants_scan_) start();
  return has_passed() && lidar_ && wants_scan_;
}

void application::act_once() {
  if (!be_scanning()) return;
  const application_behavior& m = parameters_.application;
  const milliseconds timeout = timeouts[static_cast<std::size_t>(dice_.between(0, 5))];
  if (dice_.chance(m.wake)) {
    if (dice_.chance(0.5)) {
      wake();
    } else {
      environment_.wake_ns = now() + dice_.between(0, second);
    }
  }
  if (dice_.chance(m.sleep) && now() - awake_ns_ >= awake_between_ns) {
    const std::int64_t slept_ns = dice_.between(0, m.longest_sleep_ns);
    log(text_of("sleep %.3f s", in_seconds(slept_ns)));
    sleep_until(std::min(now() + slept_ns, parameters_.calm_ns));
    awake_ns_ = now();
    return;
  }
  if (dice_.chance(m.ask)) return ask();
  if (dice_.chance(m.stop)) return stop();
  if (dice_.chance(m.reopen)) return close(dice_.chance(0.5));
  if (dice_.chance(m.move)) {
    lidar_ = std::make_unique<lidar>(std::move(*lidar_));
    checker_.moved(*lidar_);
  }
  const double sum = m.scans + m.points + m.process;
  const double drawn = dice_.real(0.0, sum);
  if (drawn < m.scans) return read_scan(timeout);
  if (drawn < m.scans + m.points) return read_points(timeout);
  process();
}

void application::act() {
  act_once();
  check_progress();
}

void application::calm_down() {
  log("calm");
  environment_.wake_ns = never_ns;
}

void application::read_calmly() {
  if (be_scanning()) read_scan(milliseconds(200));
}

void application::finish() {
  checker_.check_recognition();
  close(dice_.chance(0.5));
  sleep_until(now() + 100 * ms);
  if (!parameters_.device.one_way && !environment_.device.is_idle_and_silent(now()))
    fail("the device does not end idle and silent");
}

run_report application::report() {
  if (lidar_) {
    checker_.end();
    lidar_.reset();
  }
  report_.failure = checker_.failure();
  report_.truths = checker_.truths();
  report_.times = checker_.times();
  report_.holes = checker_.holes();
  report_.scans = checker_.scans();
  report_.simulated_ns = now();
  if (!report_.failure.empty()) log(text_of("FAILED: %s", report_.failure.c_str()));
  return report_;
}

}  // namespace g4lidar::simulation
