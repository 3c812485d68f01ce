// SPDX-License-Identifier: MIT
// Signals end open() and find_lidars(), too, during which there is no lidar to wake.
#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "g4lidar/transport/forwarding.hpp"

namespace g4lidar::python {

/// The handlers of signals while a connection is opened, in one thread and without the GIL.
class handled_signals {
 public:
  /// Calls handlers that are due, at most every 50 ms. Whether one has raised.
  [[nodiscard]] bool have_raised() noexcept;
  /// Ends the interruptions, and raises what a handler has raised. Needs the GIL.
  void end();
  /// The end of a wait after which have_raised() is to be asked.
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns, std::int64_t deadline_ns) const noexcept;

 private:
  std::chrono::steady_clock::time_point due_{};
  std::optional<nanobind::python_error> raised_;
  bool ended_ = false;
};

/// Its waits fail with gone after a handler has raised.
class interruptible_transport final : public forwarding_transport {
 public:
  interruptible_transport(std::unique_ptr<transport> inner,
                          std::shared_ptr<handled_signals> by) noexcept
      : forwarding_transport(std::move(inner)), by_(std::move(by)) {}
  [[nodiscard]] result<received> read(std::span<std::uint8_t> out,
                                      std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] result<void> pause(std::int64_t deadline_ns) noexcept override;

 private:
  std::shared_ptr<handled_signals> by_;
};

/// Makes such transports.
class interruptible_connector final : public forwarding_connector {
 public:
  interruptible_connector(std::unique_ptr<connector> inner,
                          std::shared_ptr<handled_signals> by) noexcept
      : forwarding_connector(std::move(inner)), by_(std::move(by)) {}
  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override;

 private:
  std::shared_ptr<handled_signals> by_;
};

}  // namespace g4lidar::python
