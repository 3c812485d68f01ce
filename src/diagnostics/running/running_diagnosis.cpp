// SPDX-License-Identifier: MIT
// The transport of a lidar in use, observed.
#include "g4lidar/diagnostics/running_diagnosis.hpp"

#include <algorithm>
#include <cerrno>
#include <new>
#include <span>
#include <utility>

#include "g4lidar/recording/contents.hpp"
#include "g4lidar/transport/transport.hpp"
#include "read_times.hpp"
#include "running_state.hpp"

namespace g4lidar {
namespace {

/// A transport whose bytes are judged.
class observed_transport final : public forwarding_transport {
 public:
  observed_transport(std::unique_ptr<transport> port, running_state& into) noexcept
      : forwarding_transport(std::move(port)), into_(&into) {
    times_.reset(now_ns());
    into_->connected(inner());
  }
  observed_transport(const observed_transport&) = delete;
  observed_transport& operator=(const observed_transport&) = delete;
  ~observed_transport() override { into_->disconnected(); }

  // In slices, so that a pause of the host is noticed.
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    if (!into_->is_device()) {
      auto got = inner().read(out, deadline_ns);
      if (got && got->count > 0) take(*got, out, got->arrival_ns);
      return got;
    }
    std::int64_t begin_ns = now_ns();
    while (true) {
      const std::int64_t until_ns = std::min(deadline_ns, begin_ns + longest_read_ns);
      auto got = inner().read(out, until_ns);
      const std::int64_t end_ns = now_ns();
      times_.waited(begin_ns, until_ns, end_ns, got ? got->count : 0);
      if (got && got->count > 0) {
        take(*got, out, end_ns);
        return got;
      }
      if (!got || end_ns >= deadline_ns) {
        into_->passed(end_ns);
        return got;
      }
      begin_ns = end_ns;
    }
  }
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    auto sent = inner().write(data, deadline_ns);
    if (sent) into_->sent(data, now_ns(), times_.silence_ns());
    return sent;
  }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    const std::int64_t begin_ns = now_ns();
    auto paused = inner().pause(deadline_ns);
    const std::int64_t end_ns = now_ns();
    times_.paused(begin_ns, std::min(deadline_ns, end_ns), end_ns);
    return paused;
  }

 private:
  void take(const received& got, std::span<const std::uint8_t> out, std::int64_t now_ns) noexcept {
    const timed_read what = times_.take(got.count, got.arrival_ns, got.count == out.size());
    into_->received(what, bytes(out).first(got.count), now_ns);
  }

  running_state* into_;
  read_times times_;
};

class observed_connector final : public forwarding_connector {
 public:
  observed_connector(std::unique_ptr<connector> opener, running_state& into) noexcept
      : forwarding_connector(std::move(opener)), into_(&into) {}

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto port = inner().connect();
    if (!port) return port;
    auto* const made = new (std::nothrow) observed_transport(std::move(*port), *into_);
    if (made == nullptr) return failure(task::opening, problem::system, {}, ENOMEM);
    return std::unique_ptr<transport>(made);
  }
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override {
    const bool ended = inner().pause(deadline_ns);
    into_->passed(now_ns());
    return ended;
  }

 private:
  running_state* into_;
};

}  // namespace

class running_diagnosis::state final : public running_state {
 public:
  using running_state::running_state;
};

running_diagnosis::running_diagnosis(const running_diagnosis_options& options)
    : state_(std::make_unique<state>(options)) {}
running_diagnosis::~running_diagnosis() = default;

std::unique_ptr<connector> running_diagnosis::observe(std::unique_ptr<connector> from) {
  recording_hook* const hook = recording_hook_of(*from);
  recorded_event_source* const played = hook != nullptr ? hook->events() : nullptr;
  const connector_traits known = from->traits();
  state_->begin(known.answers, played != nullptr ? &played->device() : nullptr,
                known.recognised.model != nullptr ? *known.recognised.model : g4_model);
  return std::make_unique<observed_connector>(std::move(from), *state_);
}

void running_diagnosis::add(const lidar_event& what) { state_->add(what); }
void running_diagnosis::add(const error& why) { state_->add(why); }
std::vector<stage_report> running_diagnosis::stages(const point_filter& directions) const {
  return state_->stages(directions);
}
std::vector<stage_report> running_diagnosis::stages(const filter_settings& wanted) const {
  return stages(wanted.complete_filter());
}

}  // namespace g4lidar
