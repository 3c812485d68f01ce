// SPDX-License-Identifier: MIT
// The faults of a simulated lidar and their times.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <variant>

#include "g4lidar/detail/api.hpp"

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

}  // namespace g4lidar::sim
