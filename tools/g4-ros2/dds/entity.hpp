// SPDX-License-Identifier: MIT
// Owns a handle of Cyclone DDS.
#pragma once

#include <dds/dds.h>

#include <memory>
#include <utility>

namespace g4_tool::dds {

/// Owns a participant, topic, writer, ... with everything that was created in it. May be empty.
class entity {
 public:
  entity() = default;
  /// `handle`: the result of a dds_create function; empty for an error.
  explicit entity(dds_entity_t handle) noexcept : handle_(handle > 0 ? handle : 0) {}
  entity(entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  entity& operator=(entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~entity() {
    if (handle_ > 0) static_cast<void>(dds_delete(handle_));
  }

  [[nodiscard]] dds_entity_t get() const noexcept { return handle_; }
  [[nodiscard]] explicit operator bool() const noexcept { return handle_ > 0; }

 private:
  dds_entity_t handle_ = 0;
};

using qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;

}  // namespace g4_tool::dds
