// SPDX-License-Identifier: MIT
#include "abandonable.hpp"

#include <algorithm>
#include <cerrno>
#include <new>

namespace g4lidar::python {
namespace {

/// The end of a wait after which the progress is asked.
std::int64_t next_ns(progress now, std::int64_t now_ns, std::int64_t deadline_ns) noexcept {
  constexpr std::chrono::nanoseconds interval = std::chrono::milliseconds(20);
  return now == progress::done ? deadline_ns
                               : std::min<std::int64_t>(deadline_ns, now_ns + interval.count());
}

}  // namespace

result<received> abandonable_transport::read(std::span<std::uint8_t> out,
                                             std::int64_t deadline_ns) noexcept {
  while (*of_work_ != progress::abandoned) {
    const std::int64_t until_ns = next_ns(*of_work_, now_ns(), deadline_ns);
    auto got = inner().read(out, until_ns);
    if (!got || got->count > 0 || until_ns == deadline_ns) return got;
  }
  return failure(task::reading, problem::gone, name());
}

result<void> abandonable_transport::pause(std::int64_t deadline_ns) noexcept {
  while (*of_work_ != progress::abandoned) {
    const std::int64_t until_ns = next_ns(*of_work_, now_ns(), deadline_ns);
    auto paused = inner().pause(until_ns);
    if (!paused || until_ns == deadline_ns) return paused;
  }
  return failure(task::reading, problem::gone, name());
}

result<std::unique_ptr<transport>> abandonable_connector::connect() noexcept {
  auto made = inner().connect();
  if (!made) return made;
  auto* const wrapped = new (std::nothrow) abandonable_transport(std::move(*made), of_work_);
  if (wrapped == nullptr) return failure(task::opening, problem::system, {}, ENOMEM);
  return std::unique_ptr<transport>(wrapped);
}

}  // namespace g4lidar::python
