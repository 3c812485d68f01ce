// SPDX-License-Identifier: MIT
// Signals end open() and find_lidars() at once, although some of their waits cannot be ended: for a name server, for a
// network address, and for the answers of ports that are asked one after the other.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <utility>

#include "g4lidar/transport/transport.hpp"
#include "gil.hpp"
#include "interruption.hpp"

namespace g4lidar::python {

/// What has become of a piece of work: `abandoned` if the caller has stopped waiting.
enum class progress : std::uint8_t { running, abandoned, done };
using shared_progress = std::shared_ptr<std::atomic<progress>>;

/// The result of `work()` in a thread of its own, which owns what it uses, and uses nothing of Python; all of that is
/// gone when there is a result. If the handler of a signal raises, that is raised at once: `of_work` becomes abandoned,
/// and the thread ends by itself; it is given a moment for this. Needs the GIL.
template <class Work>
auto in_background(Work work, const shared_progress& of_work) {
  constexpr std::chrono::milliseconds moment(100);
  std::packaged_task<decltype(work())()> task([owned = std::optional(std::move(work))]() mutable {
    auto made = (*owned)();
    owned.reset();
    return made;
  });
  auto found = task.get_future();
  {
    const without_signals masked;
    std::thread(std::move(task)).detach();
  }
  while (true) {
    {
      const without_gil free;
      if (found.wait_for(std::chrono::milliseconds(20)) == std::future_status::ready) break;
    }
    if (PyErr_CheckSignals() == 0) continue;
    *of_work = progress::abandoned;
    {
      const without_gil free;
      static_cast<void>(found.wait_for(moment));
    }
    throw nanobind::python_error();
  }
  *of_work = progress::done;
  return found.get();
}

/// Its waits fail with gone when the work is abandoned.
class abandonable_transport final : public forwarding_transport {
 public:
  abandonable_transport(std::unique_ptr<transport> inner, shared_progress of_work) noexcept
      : forwarding_transport(std::move(inner)), of_work_(std::move(of_work)) {}
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override;

 private:
  shared_progress of_work_;
};

/// Makes such transports.
class abandonable_connector final : public forwarding_connector {
 public:
  abandonable_connector(std::unique_ptr<connector> inner, shared_progress of_work) noexcept
      : forwarding_connector(std::move(inner)), of_work_(std::move(of_work)) {}
  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override;

 private:
  shared_progress of_work_;
};

}  // namespace g4lidar::python
