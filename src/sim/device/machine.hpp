// SPDX-License-Identifier: MIT
// The events in a simulated lidar, one after the other, independent of the calls from outside. So the
// behaviour does not depend on how often it is called.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "answerer.hpp"
#include "bridge.hpp"
#include "command_effects.hpp"
#include "command_queues.hpp"
#include "fault_injector.hpp"
#include "g4lidar/sim/device.hpp"
#include "host_port.hpp"
#include "motor.hpp"
#include "transmitter.hpp"

namespace g4lidar::sim {

/// The USB plug: pulled by a fault or by hand.
class usb_plug {
 public:
  /// Somebody keeps it unplugged, or does not any more.
  void hold_unplugged(bool held) noexcept { is_held_ = held; }
  /// Returns whether the plug was pulled or put in.
  [[nodiscard]] bool update(bool pulled_by_fault) noexcept {
    const bool is_in = !is_held_ && !pulled_by_fault;
    if (is_in == is_in_) return false;
    is_in_ = is_in;
    if (is_in) ++replugs_;
    return true;
  }
  [[nodiscard]] bool is_in() const noexcept { return is_in_; }
  [[nodiscard]] std::uint64_t replugs() const noexcept { return replugs_; }

 private:
  bool is_in_ = true;
  bool is_held_ = false;
  std::uint64_t replugs_ = 0;
};

/// The commands that were received.
class command_log {
 public:
  explicit command_log(std::size_t capacity) : capacity_(capacity) { entries_.reserve(capacity); }

  void add(const asked& entry) noexcept {
    if (entries_.size() == capacity_) {
      ++missed_;
    } else {
      entries_.push_back(entry);
    }
  }
  void clear() noexcept { entries_.clear(); }
  [[nodiscard]] std::span<const asked> entries() const noexcept { return entries_; }
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  std::size_t capacity_;
  std::vector<asked> entries_;
  std::uint64_t missed_ = 0;
};

class G4LIDAR_HIDDEN device::machine {
 public:
  // Events at the same time happen in this order.
  enum class happening : std::uint8_t {
    fault_edge,
    host_byte,
    command_due,
    answer_due,
    packet_measured,
    scan_end,
    protection,
    booted,
    death,
    byte_sent,
    line_rests,
    batch_done,
  };
  struct event {
    std::int64_t at_ns;
    happening what;
  };

  machine(const world& scene, const device_options& options, std::span<const fault> faults);

  void advance(std::int64_t to_ns) noexcept;
  void write(bytes from_host) noexcept;
  [[nodiscard]] event next_event() const noexcept;
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns) const noexcept;
  [[nodiscard]] bool is_silent() const noexcept;
  void hold_unplugged(bool held) noexcept {
    plug.hold_unplugged(held);
    update_supply();
  }
  /// A fault begins or ends, the plug is pulled or put in, or the host has changed DTR.
  void update_supply() noexcept;

  [[nodiscard]] bool is_up() const noexcept { return state_ >= state::idle; }
  [[nodiscard]] bool is_scanning() const noexcept { return state_ == state::scanning; }

  const device_options options;
  // The state for the host.
  fault_injector faults;
  bridge to_host;
  transmitter output;
  command_log log;
  device_settings settings;
  motor head;
  usb_plug plug;
  host_port host;

 private:
  enum class state : std::uint8_t { off, booting, idle, scanning };
  void handle(happening what) noexcept;

  // Power and plug.
  void power_on(bool keep_settings) noexcept;
  void power_off() noexcept;
  void booted() noexcept;
  void death() noexcept;

  // Commands.
  void host_byte_arrives() noexcept;
  void execute(const due_command& asked_for) noexcept;
  [[nodiscard]] bool obey(command code) noexcept;
  [[nodiscard]] bool obey_setting(command code) noexcept;
  void use_settings() noexcept;
  [[nodiscard]] bool obey_start() noexcept;
  void answer(command to, const answer_bytes& answer, std::int64_t later_ns = 0) noexcept;

  // Scanning.
  void begin_scan(bool at_full_speed = false) noexcept;
  void stop_scan() noexcept;
  void end_scan() noexcept;
  void keep_motor() noexcept;

  command_receiver from_host_;
  answerer answers_;
  random_stream garbage_;

  std::int64_t now_ns_ = 0;
  state state_ = state::idle;
  bool browned_out_ = false;
  bool stopped_by_protection_ = false;
  std::int64_t fed_ns_ = 0;
  std::int64_t booted_ns_ = forever_ns;
  std::int64_t death_ns_ = forever_ns;
};

}  // namespace g4lidar::sim
