// SPDX-License-Identifier: MIT
#include "life.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "stage.hpp"
#include "text.hpp"

namespace g4lidar::lives {
namespace {

using std::chrono::milliseconds;

/// A call that reads is back so long after its time at the latest: what its own calls cost.
constexpr std::int64_t read_slack_ns = 3 * ms;
/// A request asks nothing after 10 s; what is under way then ends within 5 s.
constexpr std::int64_t request_ns = 15 * second;
/// Between two sleeps all that has come is read, and the protection fed.
constexpr std::int64_t awake_between_ns = 300 * ms;
/// A start makes at most 9 requests.
constexpr std::int64_t start_ns = 9 * request_ns;
/// What is told the application is looked at so often, in a fault as well.
constexpr milliseconds timeouts[] = {milliseconds(0),   milliseconds(1),   milliseconds(20),
                                     milliseconds(200), milliseconds(500), milliseconds(2000)};

class life {
 public:
  life(const life_plan& plan, bool verbose)
      : plan_(plan),
        verbose_(verbose),
        dice_(plan.seed, 0xA99),
        stage_(plan.device, plan.faults),
        watch_(plan, stage_) {
    stage_.on_call = [this] { watch_.look(); };
    stage_.wake = [this] { wake(); };
  }

  life_report run() {
    if (verbose_) std::fputs(describe(plan_).c_str(), stdout);
    while (is_well() && now() < plan_.calm_ns) {
      act();
      check_progress();
    }
    calm_down();
    while (is_well() && now() < plan_.end_ns) read_calmly();
    if (is_well()) finish();
    return report();
  }

 private:
  [[nodiscard]] std::int64_t now() const { return stage_.clock.now_ns(); }
  [[nodiscard]] bool is_well() const { return watch_.failure().empty(); }

  void say(const std::string& what) const {
    if (verbose_) std::printf("%11.6f  %s\n", in_seconds(now()), what.c_str());
  }
  void fail(const std::string& what) {
    if (is_well()) report_.failed_ns = now();
    watch_.fail(what);
  }

  /// A call that must be over by then. Gives how long it took.
  template <class Call>
  std::int64_t within(std::int64_t limit_ns, const char* name, Call&& call) {
    const std::int64_t begin_ns = now();
    watch_.app_call();
    call();
    watch_.look();
    const std::int64_t took_ns = now() - begin_ns;
    if (took_ns > limit_ns) {
      fail(std::string(name) + " took " + std::to_string(took_ns / ms) + " ms instead of " +
           std::to_string(limit_ns / ms));
    }
    if (!is_well() && report_.failed_ns == 0) report_.failed_ns = now();
    tell_events();
    tell_state();
    return took_ns;
  }

  void check_progress();
  void tell_events();
  void tell_state();
  void wake();
  void sleep_until(std::int64_t until_ns);
  void act();
  bool be_scanning();
  void open();
  void close(bool politely);
  void start();
  void stop();
  void ask();
  void read_scan(milliseconds timeout);
  void read_points(milliseconds timeout);
  void process();
  void judge(const error& what);
  void calm_down();
  void read_calmly();
  void finish();
  life_report report();

  const life_plan& plan_;
  bool verbose_;
  dice dice_;
  stage stage_;
  watch watch_;
  std::unique_ptr<lidar> lidar_;
  bool wants_scan_ = false;
  std::uint64_t taken_ = 0;  // by next_points()
  std::uint64_t scans_at_calm_ = 0;
  std::uint64_t scans_seen_ = 0;
  std::int64_t scan_seen_ns_ = 0;
  bool recovered_ = false;
  std::int64_t told_s_ = 0;
  std::int64_t awake_ns_ = 0;  // since it slept
  std::int64_t acted_ns_ = 0;
  int acts_ = 0;
  life_report report_;
};

/// The application does not act again and again at one time: each act that is refused waits.
void life::check_progress() {
  acts_ = now() - acted_ns_ < ms ? acts_ + 1 : 0;
  if (acts_ == 0) acted_ns_ = now();
  if (acts_ > 3000) fail("the application gets nowhere");
}

void life::tell_events() {
  if (!lidar_) return;
  while (const auto event = lidar_->next_event()) {
    ++report_.events[static_cast<std::size_t>(event->what)];
    say(text_of("event %s, %s at %.6f", name_of(event->what).data(), name_of(event->reason).data(),
                in_seconds(event->time_ns)));
    watch_.breaks();
    if (plan_.healthy) fail("an event in a healthy life: " + std::string(name_of(event->what)));
  }
}

/// Once a second.
void life::tell_state() {
  if (!verbose_ || now() / second == told_s_) return;
  told_s_ = now() / second;
  const auto log = stage_.device.log();
  std::string codes;
  for (const sim::asked& a : log)
    codes += text_of(" %s%02x", a.obeyed ? "" : "!", unsigned{a.code});
  stage_.device.clear_log();
  say(text_of("  device %s%s; lidar %s, %llu revolutions; asked%s",
              stage_.device.is_up() ? "up" : "down",
              stage_.device.is_scanning() ? ", scanning" : "",
              lidar_ && lidar_->is_scanning() ? "scanning" : "idle",
              static_cast<unsigned long long>(watch_.scans()), codes.c_str()));
}

void life::wake() {
  if (!lidar_) return;
  say(text_of("wake"));
  lidar_->wake();
}

void life::sleep_until(std::int64_t until_ns) {
  while (now() < until_ns && is_well()) {
    stage_.clock.advance_to(std::min(until_ns, now() + 100 * ms));
    static_cast<void>(stage_.device.is_plugged(now()));
    watch_.look();
  }
}

void life::open() {
  result<lidar> made = g4lidar::failure(task::opening, problem::timeout);
  within(request_ns, "open()",
         [&] { made = lidar::open(std::make_unique<watched_connector>(stage_), plan_.options); });
  if (!made) {
    say(text_of("open: %s", made.error().message().c_str()));
    if (plan_.healthy) fail("a healthy device does not open: " + made.error().message());
    return sleep_until(now() + 200 * ms);
  }
  say(text_of("open"));
  ++report_.opens;
  lidar_ = std::make_unique<lidar>(std::move(*made));
  taken_ = 0;
  wants_scan_ = false;
  watch_.begin(*lidar_);
}

void life::close(bool politely) {
  if (!lidar_) return;
  say(politely ? "close" : "destroy");
  report_.reconnects += lidar_->counts().reconnects;
  stage_.wake_ns = never_ns;
  report_.longest_stop_ns =
      std::max(report_.longest_stop_ns, within(request_ns, "close()", [&] {
                 if (politely) {
                   const auto closed = lidar_->close();
                   if (!closed) say(text_of("close: %s", closed.error().message().c_str()));
                   if (!closed && now() > plan_.end_ns)
                     fail("close() failed: " + closed.error().message());
                   watch_.look();
                 }
                 watch_.end();
                 lidar_.reset();
               }));
}

void life::start() {
  result<void> done;
  watch_.is_breaking(true);
  const std::int64_t took_ns = within(start_ns, "start()", [&] { done = lidar_->start(); });
  if (done) watch_.is_breaking(false);
  report_.longest_start_ns = std::max(report_.longest_start_ns, took_ns);
  wants_scan_ = done.has_value();
  if (done) return say(text_of("start took %.3f s", in_seconds(took_ns)));
  say(text_of("start: %s", done.error().message().c_str()));
  if (plan_.healthy && done.error().what() != problem::cancelled) {
    fail("a healthy device does not start: " + done.error().message());
  }
  if (done.error().is_fatal() && !plan_.options.reconnect) close(dice_.chance(0.5));
  sleep_until(now() + 200 * ms);
}

void life::stop() {
  result<void> done;
  watch_.is_breaking(true);
  const std::int64_t took_ns = within(request_ns, "stop()", [&] { done = lidar_->stop(); });
  report_.longest_stop_ns = std::max(report_.longest_stop_ns, took_ns);
  say(text_of("stop: %s", done ? "done" : done.error().message().c_str()));
  wants_scan_ = false;
  if (!done) return judge(done.error());
  if (dice_.chance(0.5)) sleep_until(std::min(now() + dice_.between(0, second), plan_.calm_ns));
  if (dice_.chance(0.3)) ask();
}

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
      return requests::get_ranging();
    case 6:
      return requests::set(static_cast<ranging_frequency>(d.between(0, 2)));
    case 7:
      return requests::set(static_cast<constant_frequency>(d.between(0, 1)));
    case 8:
      return requests::step(frequency_step::up_1_hz);
    default:
      return requests::restart();
  }
}

void life::ask() {
  if (!lidar_) return;
  const bool may_stop = dice_.chance(0.7);
  const request wanted = some_request(dice_, !plan_.healthy);
  if (may_stop) watch_.is_breaking(true);
  result<answer> got = g4lidar::failure(task::asking, problem::timeout);
  const std::int64_t took_ns = within(request_ns + 5 * second, "ask()", [&] {
    got = lidar_->ask(wanted, may_stop ? while_scanning::stop_and_resume : while_scanning::refuse);
  });
  report_.longest_ask_ns = std::max(report_.longest_ask_ns, took_ns);
  // One that was woken goes on, until the next call has brought it to its end.
  if (got || got.error().what() != problem::cancelled) watch_.is_breaking(false);
  say(text_of("ask %d: %s after %.3f s", static_cast<int>(wanted.what),
              got ? "answered" : got.error().message().c_str(), in_seconds(took_ns)));
  if (!got) return judge(got.error());
}

/// An error of a call, as an application takes it.
void life::judge(const error& what) {
  const bool is_nothing = what.what() == problem::timeout || what.what() == problem::cancelled ||
                          what.what() == problem::scanning;
  if (is_nothing) return;
  say(text_of("error: %s", what.message().c_str()));
  if (what.what() == problem::not_scanning) {
    wants_scan_ = false;
  } else if (what.is_fatal()) {
    // With reconnecting the driver goes on by itself, but what was asked is not done.
    if (!plan_.options.reconnect) close(dice_.chance(0.5));
  }
}

void life::read_scan(milliseconds timeout) {
  within(std::chrono::nanoseconds(timeout).count() + read_slack_ns, "next_scan()", [&] {
    const auto found = lidar_->next_scan(timeout);
    if (!found) return judge(found.error());
    watch_.look();
    watch_.check_scan(*found);
  });
}

void life::read_points(milliseconds timeout) {
  within(std::chrono::nanoseconds(timeout).count() + read_slack_ns, "next_points()", [&] {
    const auto found = lidar_->next_points(timeout);
    if (!found) {
      if (found.error().what() == problem::timeout) watch_.check_taken(taken_, true);
      return judge(found.error());
    }
    watch_.look();
    taken_ += found->size();
    watch_.check_taken(taken_, false);
    watch_.check_stretch(*found, "next_points()");
  });
}

/// What an event loop does.
void life::process() {
  const std::int64_t due_ns =
      std::min({lidar_->next_deadline_ns(), stage_.device.next_ns(now()), now() + 200 * ms});
  sleep_until(std::max(now(), due_ns));
  if (dice_.chance(0.3)) return read_scan(milliseconds(0));
  within(read_slack_ns, "process()", [&] {
    const auto done = lidar_->process();
    if (!done) judge(done.error());
  });
}

bool life::be_scanning() {
  if (!lidar_) open();
  if (!is_well() || !lidar_) return false;
  if (!wants_scan_) start();
  return is_well() && lidar_ && wants_scan_;
}

void life::act() {
  if (!be_scanning()) return;
  const manners& m = plan_.application;
  const milliseconds timeout = timeouts[static_cast<std::size_t>(dice_.between(0, 5))];
  if (dice_.chance(m.wake)) {
    if (dice_.chance(0.5)) {
      wake();
    } else {
      stage_.wake_ns = now() + dice_.between(0, second);
    }
  }
  if (dice_.chance(m.sleep) && now() - awake_ns_ >= awake_between_ns) {
    const std::int64_t slept_ns = dice_.between(0, m.longest_sleep_ns);
    say(text_of("sleep %.3f s", in_seconds(slept_ns)));
    sleep_until(std::min(now() + slept_ns, plan_.calm_ns));
    awake_ns_ = now();
    return;
  }
  if (dice_.chance(m.ask)) return ask();
  if (dice_.chance(m.stop)) return stop();
  if (dice_.chance(m.reopen)) return close(dice_.chance(0.5));
  if (dice_.chance(m.move)) {
    lidar_ = std::make_unique<lidar>(std::move(*lidar_));
    watch_.moved(*lidar_);
  }
  const double sum = m.scans + m.points + m.process;
  const double drawn = dice_.real(0.0, sum);
  if (drawn < m.scans) return read_scan(timeout);
  if (drawn < m.scans + m.points) return read_points(timeout);
  process();
}

void life::calm_down() {
  if (!is_well()) return;
  say(text_of("calm"));
  stage_.wake_ns = never_ns;
  scans_at_calm_ = scans_seen_ = watch_.scans();
  scan_seen_ns_ = now();
}

/// The application does as it should, and revolutions must come.
void life::read_calmly() {
  if (be_scanning()) read_scan(milliseconds(200));
  if (!is_well()) return;
  const std::int64_t allowed_ns = recovery_time_ns(plan_);
  if (watch_.scans() != scans_seen_) {
    scans_seen_ = watch_.scans();
    scan_seen_ns_ = now();
  }
  if (!recovered_ && scans_seen_ >= scans_at_calm_ + 2) {
    recovered_ = true;
    report_.recovery_ns = now() - plan_.calm_ns;
    say(text_of("recovered after %.3f s", in_seconds(report_.recovery_ns)));
  }
  const std::int64_t since_ns = recovered_ ? scan_seen_ns_ : plan_.calm_ns;
  if (now() - since_ns > allowed_ns) {
    fail("no revolution within " + std::to_string(allowed_ns / ms) + " ms" +
         (recovered_ ? ", long after the last fault" : " after the last fault"));
  }
}

void life::finish() {
  if (!recovered_) fail("it has not recovered");
  close(dice_.chance(0.5));
  sleep_until(now() + 100 * ms);
  if (!stage_.device.is_idle_and_silent(now())) fail("the device does not end idle and silent");
}

life_report life::report() {
  if (lidar_) {
    watch_.end();
    lidar_.reset();
  }
  report_.failure = watch_.failure();
  report_.truths = watch_.truths();
  report_.times = watch_.times();
  report_.holes = watch_.holes();
  report_.scans = watch_.scans();
  report_.allowed_ns = recovery_time_ns(plan_);
  report_.lived_ns = now();
  if (!report_.failure.empty()) say(text_of("FAILED: %s", report_.failure.c_str()));
  return report_;
}

}  // namespace

life_report live(const life_plan& plan, bool verbose) { return life(plan, verbose).run(); }

}  // namespace g4lidar::lives
