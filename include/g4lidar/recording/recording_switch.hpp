// SPDX-License-Identifier: MIT
// Records a connection from any moment on, until any other: for a button.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "g4lidar/detail/api.hpp"
#include "g4lidar/transport/connector.hpp"

namespace g4lidar {

class recording_writer;

/// Observes a connection, and records it while it is on. A recording that begins in the middle of a scan states what
/// is set at that moment. *Single thread*, that of the lidar.
class G4LIDAR_API recording_switch {
 public:
  recording_switch();
  recording_switch(const recording_switch&) = delete;
  recording_switch& operator=(const recording_switch&) = delete;
  /// Off. A connector of observe() is destroyed before.
  ~recording_switch();

  /// `from`, observed: for lidar_options::wrap. This outlives the result. A recording that is played is returned as it
  /// is: nothing of it is recorded.
  [[nodiscard]] std::unique_ptr<connector> observe(std::unique_ptr<connector> from);

  /// Records into `to`, which must outlive it, until off(). False, and nothing is recorded, without a connection.
  [[nodiscard]] bool on(recording_writer& to) noexcept;
  /// Ends it; the writer is not closed.
  void off() noexcept;

  /// The time of the latest bytes or event of the connection; nothing without a connection.
  [[nodiscard]] std::optional<std::int64_t> latest_ns() const noexcept;

 private:
  class G4LIDAR_HIDDEN observer;
  std::unique_ptr<observer> observer_;
};

}  // namespace g4lidar
