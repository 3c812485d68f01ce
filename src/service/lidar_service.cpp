// SPDX-License-Identifier: MIT
#include "g4lidar/lidar_service.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/transport/source.hpp"
#include "service/lidar_channel.hpp"
#include "service/pending_changes.hpp"
#include "service/service_core.hpp"
#include "service/standby.hpp"

namespace g4lidar {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t most_lidars = 32;
/// Between two looks at what sinks want, and at changes that wait.
constexpr auto standby_interval = 100ms;
constexpr auto change_interval = 20ms;
/// Of a change.
constexpr std::chrono::milliseconds longest_change = std::chrono::hours(24 * 365);
/// The prefix of all statuses.
constexpr std::string_view library_name = "g4lidar: ";

bool is_filter(const named_value& value) {
  const parameter* const row = find_parameter(value.first);
  return row != nullptr && row->kind == parameter_kind::filter;
}

}  // namespace

service_sink::~service_sink() = default;

std::int64_t service_scan::stamp_ns(std::int64_t time_ns) const noexcept {
  if (!ahead_ns) return 0;
  return std::max<std::int64_t>(0, detail::saturating_add(time_ns, *ahead_ns));
}

struct lidar_service::state {
  state(std::vector<service_lidar> lidars, service_options options,
        const std::vector<service_output>& outputs)
      : core(std::move(options), lidars, outputs) {
    for (service_lidar& each : lidars)
      channels.emplace_back(std::move(each), channels.size(), core);
    core.begin(channels.front().has_odometry());
  }

  service_core core;
  std::deque<lidar_channel> channels;
  pending_changes changes;
  standby resting;   // of the supervisor
  std::mutex mutex;  // protects the next three
  std::condition_variable changed;
  bool is_over = false;
  bool is_new = false;
  std::atomic<bool> is_allowed = true;
  std::mutex rest_mutex;  // protects the next one
  bool is_resting = false;
  std::mutex start_mutex;  // of start() and stop(); protects the next one
  std::thread supervisor;

  /// A request wakes the threads of the lidars.
  void rest(bool wants_rest) {
    const std::lock_guard lock(rest_mutex);
    const bool rests = wants_rest || !is_allowed;
    if (std::exchange(is_resting, rests) == rests) return;
    for (lidar_channel& each : channels) each.reader().rest(rests);
  }
  void update_rest() {
    const bool is_needed = !core.options().is_standby || core.sinks().wanted().has_any();
    rest(resting.rests(is_needed, standby::time_point::clock::now()));
  }
  [[nodiscard]] result<void> begin();
  void supervise();
  [[nodiscard]] bool is_ended() {
    const std::lock_guard lock(mutex);
    return is_over;
  }
  void wake() {
    {
      const std::lock_guard lock(mutex);
      is_new = true;
    }
    changed.notify_one();
  }
  std::vector<diagnostic_status> statuses_of(lidar_channel& channel, const std::string* why) const;
};

result<void> lidar_service::state::begin() {
  if (supervisor.joinable()) return {};
  if (is_ended()) return failure(task::starting, problem::gone, "this service, which was stopped");
  if (const auto started = core.sinks().start(); !started) return started;
  update_rest();
  try {
    supervisor = std::thread([this] { supervise(); });
  } catch (const std::system_error& refused) {
    return failure(task::starting, problem::system, "a thread", refused.code().value());
  }
  changes.begin();
  return {};
}

void lidar_service::state::supervise() {
  std::unique_lock lock(mutex);
  while (!is_over) {
    is_new = false;
    lock.unlock();
    update_rest();
    const bool has_changes = changes.update([this](std::size_t lidar) {
      return channels[lidar].reader().status().state == reader_state::opening;
    });
    lock.lock();
    const auto is_due = [this] { return is_over || is_new; };
    if (has_changes)
      changed.wait_for(lock, change_interval, [this] { return is_over; });
    else if (core.options().is_standby)
      changed.wait_for(lock, standby_interval, is_due);
    else
      changed.wait(lock, is_due);
  }
}

result<std::unique_ptr<lidar_service>> lidar_service::make(std::vector<service_lidar> lidars,
                                                           service_options options,
                                                           std::vector<service_output> outputs) {
  if (lidars.empty() || lidars.size() > most_lidars)
    return failure(task::opening, problem::bad_option, "lidars: 1 to 32 can be read at once");
  const bool is_merged = lidars.size() > 1 || options.merges;
  for (std::size_t i = 0; i < lidars.size(); ++i) {
    if (is_merged && names_file(lidars[i].options.device))
      return failure(task::opening, problem::bad_option,
                     "merging " + lidars[i].options.device + ": a file has a clock of its own");
    const auto later = std::span(lidars).subspan(i + 1);
    if (std::ranges::find(later, lidars[i].name, &service_lidar::name) != later.end())
      return failure(task::opening, problem::bad_option, "two lidars have the same name");
    for (const auto& [name, value] : lidars[i].settings) {
      const parameter* const row = find_parameter(name);
      if (row == nullptr || row->kind != parameter_kind::device)
        return failure(task::opening, problem::bad_option, "there is no setting " + name);
    }
  }
  if (std::ranges::find(outputs, nullptr, &service_output::sink) != outputs.end())
    return failure(task::opening, problem::bad_option, "an output has no sink");
  return std::unique_ptr<lidar_service>(
      new lidar_service(std::make_unique<state>(std::move(lidars), std::move(options), outputs)));
}

lidar_service::lidar_service(std::unique_ptr<state> made) : state_(std::move(made)) {}
lidar_service::~lidar_service() { stop(); }

result<void> lidar_service::start() {
  const std::lock_guard lock(state_->start_mutex);
  if (const auto started = state_->begin(); !started) return started;
  for (lidar_channel& each : state_->channels) {
    if (const auto reads = each.reader().start(); !reads) return reads;
  }
  return {};
}

void lidar_service::stop() noexcept {
  const std::lock_guard only(state_->start_mutex);
  {
    const std::lock_guard lock(state_->mutex);
    state_->is_over = true;
  }
  state_->changed.notify_one();
  if (state_->supervisor.joinable()) state_->supervisor.join();
  state_->changes.end();
  state_->rest(true);  // all at once, before each is waited for
  for (lidar_channel& each : state_->channels) each.reader().stop();
  state_->core.sinks().stop();
}

void lidar_service::allow(bool runs) noexcept {
  state_->is_allowed = runs;
  if (!runs) state_->rest(true);  // at once
  state_->wake();
}

std::size_t lidar_service::size() const noexcept { return state_->channels.size(); }

bool lidar_service::has_odometry() const noexcept {
  return state_->channels.front().has_odometry();
}

reader_status lidar_service::status(std::size_t lidar) const {
  return state_->channels[lidar].reader().status();
}

std::optional<error> lidar_service::failure_of(std::size_t lidar) const {
  const std::optional<error> why = status(lidar).why;
  return why && state_->channels[lidar].is_failure(*why) ? why : std::nullopt;
}

bool lidar_service::has_ended() const {
  return std::ranges::all_of(state_->channels, [](const lidar_channel& each) {
    return each.reader().status().state == reader_state::ended;
  });
}

lidar_counts lidar_service::counts(std::size_t lidar) const {
  return state_->channels[lidar].reader().counts();
}

void lidar_service::ask(std::size_t lidar, std::function<void(g4lidar::lidar*)> what) {
  state_->channels[lidar].reader().ask(std::move(what));
}

std::vector<stage_report> lidar_service::stages(std::size_t lidar) const {
  return state_->channels[lidar].diagnosis().stages(state_->core.filters().current_filters());
}

const model* lidar_service::model(std::size_t lidar) const {
  return state_->channels[lidar].model();
}

parameter_value lidar_service::value(std::size_t lidar, const parameter& row) const {
  if (row.kind == parameter_kind::filter) return state_->core.filters().value(row);
  return state_->channels[lidar].settings().value(row);
}

std::int64_t lidar_service::stamp_ns(std::size_t lidar, std::int64_t time_ns) const {
  return service_scan{.ahead_ns = state_->channels[lidar].ahead_ns()}.stamp_ns(time_ns);
}

void lidar_service::change(std::size_t lidar, std::vector<named_value> wanted,
                           std::function<void(const std::string&)> done,
                           std::chrono::milliseconds longest) {
  std::vector<named_value> filters;
  std::vector<named_value> device;
  for (named_value& each : wanted) (is_filter(each) ? filters : device).push_back(std::move(each));
  service_core& core = state_->core;
  if (device.empty()) return done(core.set_filters(filters));
  if (const std::string wrong = core.problem_with(filters); !wrong.empty()) return done(wrong);
  const auto until = pending_change::clock::now() + std::clamp(longest, 0ms, longest_change);
  const auto made = std::make_shared<pending_change>(lidar, until, std::move(done));
  if (!state_->changes.add(made)) return made->finish("the lidar is not connected");
  lidar_channel& channel = state_->channels[lidar];
  channel.reader().ask(
      [this, &channel, made, filters, settings = std::move(device)](g4lidar::lidar* found) {
        if (!made->claim()) return;
        // Others may have changed filters since then, and while the lidar is set.
        std::string wrong = state_->core.problem_with(filters);
        if (wrong.empty())
          wrong = channel.set(found, settings, [&] { return state_->core.set_filters(filters); });
        made->finish(wrong);
        // Also if it is refused: what was made before may not be undone.
        state_->core.sinks().call([&](service_sink& to) { to.on_values(made->lidar(), {}); });
      });
  state_->wake();
}

std::string lidar_service::change_now(std::size_t lidar, std::vector<named_value> wanted,
                                      std::chrono::milliseconds longest) {
  const auto made = std::make_shared<std::promise<std::string>>();
  auto coming = made->get_future();
  change(
      lidar, std::move(wanted), [made](const std::string& why_not) { made->set_value(why_not); },
      longest);
  return coming.get();
}

void lidar_service::pause(bool pauses) {
  for (lidar_channel& each : state_->channels) each.reader().pause(pauses);
}

result<void> lidar_service::set_speed(double speed) {
  for (lidar_channel& each : state_->channels) {
    if (const auto set = each.reader().set_speed(speed); !set) return set;
  }
  return {};
}

void lidar_service::seek(std::int64_t position_ns) {
  for (lidar_channel& each : state_->channels) each.reader().seek(position_ns);
}

std::vector<diagnostic_status> lidar_service::state::statuses_of(lidar_channel& channel,
                                                                 const std::string* why) const {
  const reader_status now = channel.reader().status();
  const std::string usual =
      now.why && channel.is_failure(*now.why) ? now.why->message() : std::string();
  diagnostic_status first = status_of(now, why != nullptr ? *why : usual);
  auto all = g4lidar::statuses_of(channel.diagnosis().stages(core.filters().current_filters()),
                                  channel.reader().counts(), first.hardware_id);
  all.insert(all.begin(), std::move(first));
  const std::string& name = channel.about().name;
  if (name.empty()) return all;
  for (diagnostic_status& each : all) each.name.insert(library_name.size(), name + ' ');
  return all;
}

std::vector<diagnostic_status> lidar_service::diagnosis(
    const std::function<std::string(std::size_t)>& why) {
  std::vector<diagnostic_status> all;
  for (std::size_t i = 0; i < size(); ++i) {
    const std::string text = why ? why(i) : "";
    for (diagnostic_status& made : state_->statuses_of(state_->channels[i], why ? &text : nullptr))
      all.push_back(std::move(made));
  }
  const std::string id = size() == 1 ? all.front().hardware_id : "";
  for (diagnostic_status& made : motion_diagnosis()) {
    made.hardware_id = id;
    all.push_back(std::move(made));
  }
  return all;
}

std::vector<diagnostic_status> lidar_service::motion_diagnosis() {
  return state_->core.diagnosis();
}

}  // namespace g4lidar
