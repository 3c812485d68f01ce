// SPDX-License-Identifier: MIT
// Transports and connectors with recording.
#include <cerrno>
#include <new>
#include <string>
#include <utility>

#include "g4lidar/recording/writer.hpp"
#include "g4lidar/transport/transport.hpp"
#include "new_file.hpp"
#include "recording/mcap/file_writer.hpp"
#include "recording/play/played_file.hpp"

namespace g4lidar {
namespace {

/// A transport, and the writer of its recording.
template <class Writer>
class recorded_transport final : public forwarding_transport {
 public:
  /// `played`: the events of a recording; null for a device or a file of bytes.
  recorded_transport(std::unique_ptr<transport> port, const connector& connector,
                     const recorded_event_source* played, Writer& into) noexcept
      : forwarding_transport(std::move(port)),
        from_(&connector),
        is_played_(played != nullptr),
        into_(&into) {
    follow_wall_clock();
    if (played != nullptr) {
      recorded_device known = played->device();
      known.recognised.reset();  // the driver records as which model it reads it now
      into.device(known);
      return;
    }
    recorded_event opened{.what = recorded_event::kind::opened, .time_ns = now_ns()};
    opened.baud = baud();
    opened.name = name();
    into.event(opened);
  }
  recorded_transport(const recorded_transport&) = delete;
  recorded_transport& operator=(const recorded_transport&) = delete;
  ~recorded_transport() override {
    if (is_played_) return;  // a recording reports its own events
    into_->event({.what = recorded_event::kind::closed, .reason = reason_, .time_ns = now_ns()});
  }

  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override {
    auto got = inner().read(out, deadline_ns);
    if (!got) {
      remember(got.error());
    } else if (got->count > 0) {
      follow_wall_clock();
      into_->put_bytes(direction::from_device, bytes(out).first(got->count), got->arrival_ns);
    }
    return got;
  }
  [[nodiscard]] result<void> write(bytes data, std::int64_t deadline_ns) noexcept override {
    const std::int64_t begun_ns = now_ns();
    auto sent = inner().write(data, deadline_ns);
    if (!sent) {
      remember(sent.error());
    } else if (from_->traits().answers) {
      into_->put_bytes(direction::to_device, data, begun_ns);
    }
    return sent;
  }
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override {
    auto paused = inner().pause(deadline_ns);
    if (!paused) remember(paused.error());
    return paused;
  }

 private:
  void remember(const error& why) noexcept {
    if (why != problem::cancelled && why != problem::timeout) reason_ = why.code();
  }
  void follow_wall_clock() noexcept {
    if (const auto ahead_ns = from_->traits().wall_ahead_ns) into_->set_wall_clock(*ahead_ns);
  }

  const connector* from_;
  bool is_played_;
  Writer* into_;
  problem reason_ = problem::cancelled;  // it was closed
};

/// Records the bytes of its transports, the events of the driver, and the events of a recording.
template <class Writer>
class recorded_connector final : public forwarding_connector,
                                 public recording_hook,
                                 private recorded_event_source {
 public:
  recorded_connector(std::unique_ptr<connector> opener, Writer& into) noexcept
      : forwarding_connector(std::move(opener)),
        into_(&into),
        inner_hook_(recording_hook_of(inner())),
        played_(inner_hook_ != nullptr ? inner_hook_->events() : nullptr) {
    if (played_file* const played = file_of(inner())) played->controls().forbid_seek();
  }

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override {
    auto port = inner().connect();
    if (!port) return port;
    auto* const made =
        new (std::nothrow) recorded_transport<Writer>(std::move(*port), *this, played_, *into_);
    if (made == nullptr) return failure(task::opening, problem::system, {}, ENOMEM);
    return std::unique_ptr<transport>(made);
  }

 private:
  [[nodiscard]] recorded_event_source* events() noexcept override {
    return played_ != nullptr ? this : nullptr;
  }
  void event(const recorded_event& what) noexcept override {
    if (inner_hook_ != nullptr) inner_hook_->event(what);
    into_->event(what);
  }
  void recognised(const recognition& what) noexcept override {
    if (inner_hook_ != nullptr) inner_hook_->recognised(what);
    const bool is_same = recognised_ && recognised_->model == what.model &&
                         recognised_->by == what.by && recognised_->number == what.number &&
                         recognised_->baud == what.baud &&
                         recognised_->is_silent == what.is_silent &&
                         recognised_->speaks_telnet == what.speaks_telnet;
    if (is_same) return;  // after a reconnect
    recognised_ = what;
    recognised_->candidates = {};  // which are valid as long as the lidar
    into_->device({.recognised = recognised_, .candidates = set_of(what.candidates)});
  }

  [[nodiscard]] std::optional<recorded_event> next_event() noexcept override {
    const auto what = played_->next_event();
    if (what) {
      if (const auto ahead_ns = traits().wall_ahead_ns) into_->set_wall_clock(*ahead_ns);
      into_->event(*what);
    }
    return what;
  }
  [[nodiscard]] const recorded_device& device() const noexcept override {
    return played_->device();
  }
  [[nodiscard]] std::int64_t caller_ns() const noexcept override { return played_->caller_ns(); }
  [[nodiscard]] std::int64_t deadline_after_ns(std::int64_t timeout_ns) const noexcept override {
    return played_->deadline_after_ns(timeout_ns);
  }
  [[nodiscard]] std::int64_t recorded_ns(std::int64_t deadline_ns) const noexcept override {
    return played_->recorded_ns(deadline_ns);
  }
  [[nodiscard]] std::int64_t wait_for_next_ns() noexcept override {
    return played_->wait_for_next_ns();
  }
  [[nodiscard]] bool take_cancelled() noexcept override { return played_->take_cancelled(); }

  Writer* into_;
  recording_hook* inner_hook_;     // null: a device that nobody else records
  recorded_event_source* played_;  // null: a device, or a file without events
  std::optional<recognition> recognised_;
};

}  // namespace

recording_hook* recording_hook_of(connector& from) noexcept {
  for (connector* each = &from; each != nullptr; each = each->wrapped()) {
    if (auto* const found = dynamic_cast<recording_hook*>(each)) return found;
  }
  return nullptr;
}

result<std::unique_ptr<connector>> recorded(std::unique_ptr<connector> connector,
                                            recording_writer& into) {
  using writer = recording_writer::file_writer;
  if (!into.made_) return connector;  // a moved-from writer records nothing
  const played_file* const played = file_of(*connector);
  if (played != nullptr &&
      are_one_file(std::string(played->items().path()), into.made_->place().path())) {
    return failure(task::opening, problem::bad_option,
                   "the file of the recording is also its source");
  }
  const connector_traits behind = connector->traits();
  const model* const stated =
      behind.begun_as != nullptr ? behind.begun_as : behind.recognised.model;
  if (stated != nullptr) {
    if (auto taken = into.made_->take_model(*stated); !taken) return tl::unexpected(taken.error());
  }
  return std::make_unique<recorded_connector<writer>>(std::move(connector), *into.made_);
}

/// What is recorded goes to the writer, if it is on. The state of the connection is known always.
class recording_switch::observer {
 public:
  void put_bytes(direction flow, bytes data, std::int64_t time_ns) noexcept {
    latest_ns_ = time_ns;
    if (to_ == nullptr) return;
    flow == direction::from_device ? to_->from_device(data, time_ns)
                                   : to_->to_device(data, time_ns);
  }
  void event(const recorded_event& what) noexcept {
    latest_ns_ = what.time_ns;
    state_.take(what);
    if (to_ != nullptr) to_->event(what);
  }
  void device(const recorded_device& known) noexcept {
    if (known.recognised) recognised_ = known;
    if (to_ != nullptr) to_->device(known);
  }
  void set_wall_clock(std::int64_t ahead_ns) noexcept {
    wall_ahead_ns_ = ahead_ns;
    if (to_ != nullptr) to_->set_wall_clock(ahead_ns);
  }

  [[nodiscard]] bool on(recording_writer& to) noexcept {
    if (!state_.is_open) return false;
    to_ = &to;
    if (wall_ahead_ns_) to.set_wall_clock(*wall_ahead_ns_);
    to.event(state_.as_event(latest_ns_));
    if (recognised_) to.device(*recognised_);
    return true;
  }
  void off() noexcept { to_ = nullptr; }

  [[nodiscard]] std::optional<std::int64_t> latest_ns() const noexcept {
    return state_.is_open ? std::optional(latest_ns_) : std::nullopt;
  }

 private:
  mcap::transport_state state_;
  std::int64_t latest_ns_ = 0;
  std::optional<std::int64_t> wall_ahead_ns_;
  std::optional<recorded_device> recognised_;
  recording_writer* to_ = nullptr;  // null: off
};

recording_switch::recording_switch() : observer_(std::make_unique<observer>()) {}

recording_switch::~recording_switch() = default;

std::unique_ptr<connector> recording_switch::observe(std::unique_ptr<connector> from) {
  if (file_of(*from) != nullptr) return from;
  return std::make_unique<recorded_connector<observer>>(std::move(from), *observer_);
}

bool recording_switch::on(recording_writer& to) noexcept { return observer_->on(to); }

void recording_switch::off() noexcept { observer_->off(); }

std::optional<std::int64_t> recording_switch::latest_ns() const noexcept {
  return observer_->latest_ns();
}

}  // namespace g4lidar
