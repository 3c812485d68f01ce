// SPDX-License-Identifier: MIT
// Owns a handle of Cyclone DDS.
#pragma once

#include <dds/dds.h>

#include <array>
#include <cstddef>
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

/// Takes all that is new, and calls `use` with each sample and what is known about it.
inline void take_all(const entity& reader, auto use) {
  std::array<void*, 64> samples{};
  std::array<dds_sample_info_t, 64> about{};
  while (reader) {
    const dds_return_t count =
        dds_take(reader.get(), samples.data(), about.data(), samples.size(), samples.size());
    if (count <= 0) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) use(samples[i], about[i]);
    static_cast<void>(dds_return_loan(reader.get(), samples.data(), count));
  }
}

using qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;

}  // namespace g4_tool::dds
