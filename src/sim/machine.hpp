// SPDX-License-Identifier: MIT
// The events in a simulated G4, one after the other, independent of the calls from outside. So the
// behaviour does not depend on how often it is called.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bridge.hpp"
#include "fault_line.hpp"
#include "g4lidar/sim/device.hpp"
#include "motor.hpp"
#include "ring.hpp"
#include "settings.hpp"
#include "truth_log.hpp"
#include "wire.hpp"

namespace g4lidar::sim {

class G4LIDAR_HIDDEN device::machine {
 public:
  machine(const world& scene, const device_options& options, std::span<const fault> faults);

  void advance(std::int64_t to_ns) noexcept;
  void write(bytes from_host) noexcept;
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns) const noexcept;
  [[nodiscard]] bool is_silent() const noexcept;
  /// Whether advance() has processed everything up to this time.
  [[nodiscard]] bool is_settled(std::int64_t now_ns) const noexcept {
    return next_event().at_ns > now_ns;
  }

  void hold_unplugged(bool held) noexcept {
    held_unplugged_ = held;
    fault_edge();
  }
  [[nodiscard]] std::int64_t next_edge_ns() const noexcept { return faults_.next_edge_ns(); }

  // The state for the host.
  bridge to_host;
  truth_log truths;
  std::vector<asked> log;
  std::uint64_t log_missed = 0;
  device_settings settings;
  motor head;
  std::uint64_t replugs = 0;
  bool plugged = true;

  [[nodiscard]] bool is_up() const noexcept { return state_ >= state::idle; }
  [[nodiscard]] bool is_scanning() const noexcept { return state_ == state::scanning; }

 private:
  enum class state : std::uint8_t { off, booting, idle, scanning };
  // Events at the same time happen in this order.
  enum class happening : std::uint8_t {
    fault_edge,
    host_byte,
    command_due,
    answer_due,
    packet_measured,
    protection,
    booted,
    death,
    byte_sent,
    batch_done,
  };
  struct event {
    std::int64_t at_ns;
    happening what;
  };
  struct host_byte {
    std::int64_t at_ns;
    std::uint8_t byte;
  };
  struct pending_command {
    std::int64_t due_ns;
    std::int64_t asked_ns;
    std::uint8_t code;
  };
  struct late_answer {
    std::int64_t due_ns = forever_ns;  // forever_ns: none
    answer_bytes what;
  };

  [[nodiscard]] event next_event() const noexcept;
  void handle(happening what) noexcept;

  // Power and plug.
  void fault_edge() noexcept;
  void power_on(bool keep_settings) noexcept;
  void power_off() noexcept;
  void booted() noexcept;
  void death() noexcept;

  // Commands.
  void host_byte_arrives() noexcept;
  void execute(const pending_command& asked_for) noexcept;
  [[nodiscard]] bool obey(command code) noexcept;
  [[nodiscard]] bool obey_setting(command code) noexcept;
  void use_settings() noexcept;
  [[nodiscard]] bool obey_start() noexcept;
  [[nodiscard]] health condition() const noexcept;
  void restart() noexcept;

  // Answers.
  void answer(answer_bytes what, std::int64_t later_ns = 0) noexcept;
  [[nodiscard]] answer_bytes another_than(const answer_bytes& right) noexcept;
  void send_later(const answer_bytes& what, std::int64_t due_ns) noexcept;
  void forget_header() noexcept;
  void send(const answer_bytes& what) noexcept;
  void say(bytes content) noexcept;
  void answers_due() noexcept;

  // Scanning.
  void begin_scan() noexcept;
  void end_scan() noexcept;
  void keep_motor() noexcept;
  void measure() noexcept;
  void packet_measured() noexcept;
  void byte_sent() noexcept;

  device_options options_;
  fault_line faults_;
  scanner scanner_;
  wire wire_;
  random_stream phases_;
  random_stream strays_;
  random_stream garbage_;

  std::int64_t now_ns_ = 0;
  state state_ = state::idle;
  bool held_unplugged_ = false;
  bool browned_out_ = false;
  bool stopped_by_protection_ = false;
  bool start_byte_seen_ = false;
  std::int64_t host_free_ns_ = 0;  // the end of the last byte from the host
  ring<host_byte, 1'024> from_host_;
  ring<pending_command, 64> commands_;
  std::array<late_answer, 16> answers_{};
  std::int64_t answer_ns_ = forever_ns;  // the time of the first of them
  transmission measuring_;               // the packet that is being measured
  transmission speaking_;                // temporary
  std::uint64_t packets_ = 0;
  std::int64_t packet_ns_ = forever_ns;  // when it is complete
  std::int64_t silent_until_ns_ = 0;     // no packet is sent before this time
  bool has_answered_ = true;             // since it booted
  std::int64_t fed_ns_ = 0;
  std::int64_t booted_ns_ = forever_ns;
  std::int64_t death_ns_ = forever_ns;
};

}  // namespace g4lidar::sim
