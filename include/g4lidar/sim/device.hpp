// SPDX-License-Identifier: MIT
// A complete simulated lidar in virtual time: bytes of a host in, bytes for the host out; and its faults.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/sim/device_options.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

/// A time that never comes.
inline constexpr std::int64_t forever_ns = std::numeric_limits<std::int64_t>::max();

/// The kinds of fault. `rate` and `amount` have the meaning given for each; the defaults are in
/// braces.
enum class fault_kind : std::uint8_t {
  flip,      ///< One bit of a byte to the host is inverted: `rate` of all bytes {0.001}.
  drop,      ///< A byte to the host is lost: `rate` {0.001}.
  insert,    ///< A random byte is inserted before a byte to the host: `rate` {0.001}.
  burst,     ///< `amount` consecutive bytes to the host are random {30}: begins at `rate` {0.0001}.
  truncate,  ///< A packet ends before its end: `rate` of all packets {0.01}.
  stall,     ///< Nothing reaches the host; everything arrives when the fault ends.
  batch,     ///< Bytes to the host wait 0 to `amount` ns {16 ms}, as with some USB bridges.
  late,      ///< An answer is delayed by `amount` ns {300 ms}: `rate` of all {1}.
  wrong,     ///< A wrong but possible answer: `rate` {1}, to the command `amount`, 0: to all {0}.
  twice,     ///< An answer is sent twice: `rate` {1}, `amount` as of wrong {0}.
  mute,      ///< No answer, although the command is executed: `rate` {1}, `amount` as of wrong {0}.
  deaf,      ///< The transmit wire is broken: commands do not reach the device.
  baud,      ///< The host has another baud rate: garbage in both directions.
  scanning,  ///< When the fault begins, the device starts to scan without a command.
  brown_out,  ///< The device loses power `amount` ns {30 ms} after the motor has started, until the end.
  reboot,  ///< Like brown_out, but the device boots again immediately.
  unplug,  ///< The device is unplugged; at the end of the fault it is plugged in again.
  health,  ///< The health is `amount`: 1 a warning, 2 an error {2}.
  jolt,  ///< The head moves back for a packet: `rate` of all packets {0.01}. Such packets are suspect.
  omit,  ///< A packet is not sent: `rate` of all packets {0.01}.
};

/// The last kind, for loops over all kinds.
inline constexpr fault_kind last_fault_kind = fault_kind::omit;

/// One fault of a device, with its time.
struct fault {
  fault_kind kind;
  std::int64_t begin_ns = 0;
  std::int64_t duration_ns = forever_ns;  ///< forever_ns: unlimited.
  double rate = 0.0;
  std::int64_t amount = 0;
};

/// A permanent fault of this kind with the default rate and amount (in braces above). *Pure.*
[[nodiscard]] G4LIDAR_API fault make_fault(fault_kind kind, std::int64_t begin_ns = 0,
                                           std::int64_t duration_ns = forever_ns) noexcept;

/// What is wrong with `f`, a sentence for people; empty if nothing is. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view problem_with(const fault& f) noexcept;

/// The name of a kind: the enumerator. Valid forever. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view name_of(fault_kind kind) noexcept;

/// Why a text is not a fault: a sentence without a full stop, for people.
struct fault_error {
  std::string message;
};

/// The fault that `text` describes, `KIND[=AMOUNT][*RATE][@BEGIN[+DURATION]]`, for example
/// "unplug@5s+2s", "flip*0.001", "batch=16ms@1s", "burst=30*0.01%@500ms+1s", "mute=93". Times are decimal
/// numbers followed by ns, us, ms, s or min (0 needs no unit); docs/sim.md describes the format.
/// Independent of the locale. Throws only std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<fault, fault_error> parse_fault(std::string_view text);

/// A command that has reached the device.
struct asked {
  std::int64_t time_ns;  ///< When its second byte had arrived.
  std::uint8_t code;     ///< The second byte, known or not.
  bool obeyed;           ///< Known, not refused, and not ignored.
  bool scanning;         ///< The device was scanning.
};

/// A sample that was sent.
struct sent_sample {
  sample_truth
      truth;  ///< Its index counts the samples of all packets, including those that were never sent.
  std::uint64_t packet;   ///< Counts the packets of the device, from 0.
  std::int64_t sent_ns;   ///< When the last byte of its packet was sent.
  std::uint8_t position;  ///< Its index in the packet.
  std::uint8_t count;     ///< The number of samples in its packet.
  bool zero;              ///< Of a zero packet.
  bool whole;             ///< No byte of the packet was damaged, lost, or separated from the next.
};

class device;

/// What the host sets at its end of the connection to a device. *Single thread.*
class G4LIDAR_API host_end {
 public:
  /// Sets the rate, and discards the bytes that the host has not read. At a rate that differs by more than
  /// 2.5 to 5 % from that of the device, bytes arrive garbled in both directions, unless the options state
  /// otherwise. 0: that of the device, as at first and after a replug.
  void set_baud(std::uint32_t baud, std::int64_t now_ns) noexcept;
  /// The rate.
  [[nodiscard]] std::uint32_t baud() const noexcept;
  /// A program opens the port: the system raises DTR, if it is the first one.
  void open(std::int64_t now_ns) noexcept;
  /// A program closes the port: after the last one the system lowers DTR, unless that keeps it.
  void close(std::int64_t now_ns, bool keeps_dtr = false) noexcept;
  /// Sets the line DTR. It has no effect on most models; for the others see device_options.
  void set_dtr(bool high, std::int64_t now_ns) noexcept;
  /// The connection has no line DTR: from now on the motor is enabled.
  void ignore_dtr(std::int64_t now_ns) noexcept;

 private:
  friend class device;
  explicit host_end(device& of) noexcept : device_(&of) {}
  device* device_;
};

/// A device. All times are nanoseconds of one virtual clock that only moves forward; it ends at 2^62. The behaviour
/// does not depend on how often functions are called, except for the losses of a slow reader. The
/// same options, world, faults and writes give the same bytes on every processor. *Single thread.
/// Allocates on construction only.*
class G4LIDAR_API device {
 public:
  /// `problem_with` must be empty for the options and each fault; otherwise an assertion fails.
  explicit device(const world& scene, const device_options& options = {},
                  std::span<const fault> faults = {});
  device(device&&) noexcept;
  device& operator=(device&&) noexcept;
  ~device();

  /// The host sends bytes. They are lost while the device is unplugged.
  void write(bytes from_host, std::int64_t now_ns) noexcept;
  /// The host's end of the connection; valid as long as this, and until it is moved.
  [[nodiscard]] host_end host() noexcept;
  /// Takes the bytes that have reached the host by now; returns their number. A host that does not
  /// read loses what arrives beyond 64 KiB.
  std::size_t read(std::span<std::uint8_t> out, std::int64_t now_ns) noexcept;
  /// The same without taking anything: the number of available bytes.
  [[nodiscard]] std::size_t available(std::int64_t now_ns) noexcept;
  /// The next time at which the result may change: before it, read() returns nothing and
  /// is_plugged() does not change, if nothing is written. `now_ns` if read() returns something now,
  /// forever_ns if nothing will happen by itself.
  [[nodiscard]] std::int64_t next_ns(std::int64_t now_ns) const noexcept;

  /// Whether the host sees the port.
  [[nodiscard]] bool is_plugged(std::int64_t now_ns) noexcept;
  /// Unplugs the device, regardless of its faults.
  void unplug(std::int64_t now_ns) noexcept;
  /// Plugs the device in again.
  void replug(std::int64_t now_ns) noexcept;
  /// When a fault may next change is_plugged().
  [[nodiscard]] std::int64_t next_plug_ns() const noexcept;
  /// How often the device was plugged in, without the first time: a descriptor that was opened
  /// before the last replug is invalid.
  [[nodiscard]] std::uint64_t replugs() const noexcept;

  // The state at the last call of read(), write(), available() or is_plugged().

  /// Whether it was started and not stopped.
  [[nodiscard]] bool is_scanning() const noexcept;
  /// Whether it has power and has booted.
  [[nodiscard]] bool is_up() const noexcept;
  /// Whether the motor is powered, including spin-up; not while it runs down.
  [[nodiscard]] bool motor_turns() const noexcept;
  /// The true speed of the head at `now_ns`, in revolutions per 1000 s.
  [[nodiscard]] std::uint32_t motor_mhz(std::int64_t now_ns) const noexcept;
  /// Whether it is booted and idle, no bytes are in transit in either direction, and the motor is
  /// off (unless low power was switched off).
  [[nodiscard]] bool is_idle_and_silent(std::int64_t now_ns) const noexcept;
  /// The settings, as set by commands; valid as long as this.
  [[nodiscard]] const device_settings& settings() const noexcept;

  /// The commands received since clear_log(), the oldest first; valid until the next call of any
  /// function. If the log is full, further commands are only counted.
  [[nodiscard]] std::span<const asked> log() const noexcept;
  /// How many commands did not fit into the log.
  [[nodiscard]] std::uint64_t log_missed() const noexcept;
  /// Clears the log.
  void clear_log() noexcept;

  /// Takes the oldest sent samples that were not taken yet. The samples of a packet are available
  /// when its last byte was sent, thus before the host can receive it.
  std::size_t take_truth(std::span<sent_sample> out) noexcept;
  /// Samples that were dropped because they were not taken.
  [[nodiscard]] std::uint64_t truth_missed() const noexcept;

  /// Bytes that reached the host or were lost because it was slow.
  [[nodiscard]] std::uint64_t bytes_delivered() const noexcept;
  /// The lost ones among them.
  [[nodiscard]] std::uint64_t bytes_overflowed() const noexcept;

 private:
  friend class host_end;
  class machine;
  std::unique_ptr<machine> machine_;
};

}  // namespace g4lidar::sim
