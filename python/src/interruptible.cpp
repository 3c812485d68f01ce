// SPDX-License-Identifier: MIT
#include "interruptible.hpp"

#include <algorithm>
#include <cerrno>
#include <new>

namespace g4lidar::python {
namespace {

constexpr std::chrono::milliseconds interval{50};

}  // namespace

bool handled_signals::have_raised() noexcept {
  if (ended_ || raised_) return raised_.has_value();
  const auto now = std::chrono::steady_clock::now();
  if (now < due_) return false;
  due_ = now + interval;
  const nanobind::gil_scoped_acquire held;
  if (PyErr_CheckSignals() != 0) raised_.emplace();
  return raised_.has_value();
}

void handled_signals::end() {
  ended_ = true;
  if (!raised_) return;
  auto why = std::move(*raised_);
  raised_.reset();
  throw why;
}

std::int64_t handled_signals::next_ns(std::int64_t now_ns,
                                      std::int64_t deadline_ns) const noexcept {
  if (ended_) return deadline_ns;
  return std::min(deadline_ns, now_ns + std::chrono::nanoseconds(interval).count());
}

result<received> interruptible_transport::read(std::span<std::uint8_t> out,
                                               std::int64_t deadline_ns) noexcept {
  while (!by_->have_raised()) {
    const std::int64_t until_ns = by_->next_ns(now_ns(), deadline_ns);
    auto got = inner().read(out, until_ns);
    if (!got || got->count > 0 || until_ns == deadline_ns) return got;
  }
  return failure(task::reading, problem::gone, name());
}

result<void> interruptible_transport::pause(std::int64_t deadline_ns) noexcept {
  while (!by_->have_raised()) {
    const std::int64_t until_ns = by_->next_ns(now_ns(), deadline_ns);
    auto paused = inner().pause(until_ns);
    if (!paused || until_ns == deadline_ns) return paused;
  }
  return failure(task::reading, problem::gone, name());
}

result<std::unique_ptr<transport>> interruptible_connector::connect() noexcept {
  auto made = inner().connect();
  if (!made) return made;
  auto* const wrapped = new (std::nothrow) interruptible_transport(std::move(*made), by_);
  if (wrapped == nullptr) return failure(task::opening, problem::system, {}, ENOMEM);
  return std::unique_ptr<transport>(wrapped);
}

}  // namespace g4lidar::python
