// SPDX-License-Identifier: MIT
// A whole simulated G4 in virtual time: bytes of a host in, bytes for the host out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "g4lidar/bytes.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/fault.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

/// A command that has reached the device.
struct asked {
  std::int64_t time_ns;  ///< When its second byte was there.
  std::uint8_t code;     ///< The second byte, known or not.
  bool obeyed;           ///< Known, not refused, and not ignored.
  bool scanning;         ///< The device was scanning.
};

/// A sample that has gone down the line.
struct sent_sample {
  sample_truth truth;     ///< Its index counts samples of all packets, also of those never sent.
  std::uint64_t packet;   ///< Counts the packets of the device, from 0.
  std::int64_t sent_ns;   ///< When the last byte of its packet was through.
  std::uint8_t position;  ///< In its packet, from 0.
  std::uint8_t count;     ///< Of all samples in its packet.
  bool zero;              ///< Of a zero packet.
  bool whole;             ///< No byte of the packet was damaged, lost, or parted from the next.
};

/// A device. All times are nanoseconds of one virtual clock that only goes forward; what happens
/// does not depend on how often it is looked at, but for what a slow reader loses. Same options,
/// world, faults and writes: same bytes, on every processor. *Single thread. Allocates on
/// construction only.*
class G4LIDAR_API device {
 public:
  /// `problem_with` is empty for the options and each fault; a mistake there is an assertion.
  explicit device(const world& scene, const device_options& options = {},
                  std::span<const fault> faults = {});
  device(device&&) noexcept;
  device& operator=(device&&) noexcept;
  ~device();

  /// The host puts bytes on the line. While the plug is out they are lost.
  void write(bytes from_host, std::int64_t now_ns) noexcept;
  /// Takes what has reached the host by now; the number of bytes. A host that lets 64 KiB come
  /// together loses what comes then.
  std::size_t read(std::span<std::uint8_t> out, std::int64_t now_ns) noexcept;
  /// The same without taking anything: how many bytes are there.
  [[nodiscard]] std::size_t available(std::int64_t now_ns) noexcept;
  /// The next time at which looking again may be worth it: read() will not give anything and
  /// is_plugged() will not change before, if nothing is written. `now_ns` where read() gives
  /// something at once, forever_ns where nothing will happen by itself.
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns) const noexcept;

  /// Whether the host sees the port.
  [[nodiscard]] bool is_plugged(std::int64_t now_ns) noexcept;
  /// Pulls the plug, whatever the faults say of it meanwhile.
  void unplug(std::int64_t now_ns) noexcept;
  /// Puts the plug in again.
  void replug(std::int64_t now_ns) noexcept;
  /// When is_plugged() may next change by a fault.
  [[nodiscard]] std::int64_t next_plug_ns() const noexcept;
  /// How often the plug has been put in, the first time not counted: a descriptor that was opened
  /// before the last time is dead.
  [[nodiscard]] std::uint64_t replugs() const noexcept;

  // How it stood when it was last looked at (read(), write(), available(), is_plugged()).

  /// It has been started, and not stopped.
  [[nodiscard]] bool is_scanning() const noexcept;
  /// It has power and has booted.
  [[nodiscard]] bool is_up() const noexcept;
  /// The motor is driven, be it still spinning up. Running down does not count.
  [[nodiscard]] bool motor_turns() const noexcept;
  /// The true speed of the head at `now_ns`, in revolutions in 1000 s.
  [[nodiscard]] std::uint32_t motor_mhz(std::int64_t now_ns) const noexcept;
  /// It is up and idle, nothing of it is on its way to the host, no command is on its way, and the
  /// motor is off unless low power was switched off.
  [[nodiscard]] bool is_idle_and_silent(std::int64_t now_ns) const noexcept;
  /// What commands have set; good as long as this.
  [[nodiscard]] const device_settings& settings() const noexcept;

  /// The commands that have come since clear_log(), the oldest first; good until the next call of
  /// anything. When it is full, further ones are only counted.
  [[nodiscard]] std::span<const asked> log() const noexcept;
  /// How many commands did not fit into the log.
  [[nodiscard]] std::uint64_t log_missed() const noexcept;
  /// Forgets them all.
  void clear_log() noexcept;

  /// Takes the oldest samples that have gone down the line and were not taken yet. A packet's are
  /// there when its last byte was through, thus before the host can have it.
  std::size_t take_truth(std::span<sent_sample> out) noexcept;
  /// Samples that nobody took before there were too many.
  [[nodiscard]] std::uint64_t truth_missed() const noexcept;

  /// Bytes that reached the host or were lost to its slowness.
  [[nodiscard]] std::uint64_t bytes_delivered() const noexcept;
  /// Those of them that were lost.
  [[nodiscard]] std::uint64_t bytes_overflowed() const noexcept;

 private:
  class machine;
  std::unique_ptr<machine> machine_;
};

}  // namespace g4lidar::sim
