// SPDX-License-Identifier: MIT
// What can go wrong with a simulated G4, and when: a time line of faults.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <variant>

#include "g4lidar/export.hpp"

namespace g4lidar::sim {

/// A time that never comes.
inline constexpr std::int64_t forever_ns = std::numeric_limits<std::int64_t>::max();

/// The kinds of fault. `rate` and `amount` mean what stands behind each; in braces what they are
/// where nothing is said.
enum class fault_kind : std::uint8_t {
  flip,       ///< A byte to the host has one bit turned over: `rate` of all bytes {0.001}.
  drop,       ///< A byte to the host is lost: `rate` {0.001}.
  insert,     ///< A random byte comes before a byte to the host: `rate` {0.001}.
  burst,      ///< `amount` bytes to the host in a row are random {30}: begins at `rate` {0.0001}.
  truncate,   ///< A packet ends somewhere in its middle: `rate` of all packets {0.01}.
  stall,      ///< Nothing reaches the host; it comes late when the fault ends.
  batch,      ///< Bytes wait for the host for 0 to `amount` ns {16 ms}, as with some USB bridges.
  late,       ///< An answer comes `amount` ns late {300 ms}: `rate` of all {1}.
  wrong,      ///< Another answer than the right one, possible in itself: `rate` {1}.
  twice,      ///< An answer comes twice: `rate` {1}.
  mute,       ///< No answer, though the command is carried out: `rate` {1}.
  deaf,       ///< A dead transmit line: commands do not reach the device.
  baud,       ///< The host has another baud rate: garbage in both directions.
  scanning,   ///< At its beginning the device starts to scan, unasked.
  brown_out,  ///< The device dies `amount` ns {30 ms} after the motor has started, until the end.
  reboot,     ///< As brown_out, but it boots again at once.
  unplug,     ///< The plug is out; at the end it is put in again.
  health,     ///< The health is `amount`: 1 a warning, 2 an error {2}.
  jolt,       ///< The head goes back for a packet: `rate` of all packets {0.01}. Such are suspect.
};

/// One fault on the time line of a device.
struct fault {
  fault_kind kind;
  std::int64_t begin_ns = 0;
  std::int64_t duration_ns = forever_ns;  ///< forever_ns: for ever.
  double rate = 0.0;
  std::int64_t amount = 0;
};

/// A fault of this kind with the rate and the amount that stand in braces above, always. *Pure.*
[[nodiscard]] G4LIDAR_API fault make_fault(fault_kind kind, std::int64_t begin_ns = 0,
                                           std::int64_t duration_ns = forever_ns) noexcept;

/// What is wrong with `f`, a sentence to be shown to a person; empty if nothing is. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view problem_with(const fault& f) noexcept;

/// The word for a kind: the enumerator. It lives for ever. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view name_of(fault_kind kind) noexcept;

/// Why a text is not a fault: a sentence without a full stop, to be shown to a person.
struct fault_error {
  std::string message;
};

/// The fault that `text` describes, `KIND[=AMOUNT][*RATE][@BEGIN[+DURATION]]`, for instance
/// "unplug@5s+2s", "flip*0.001", "batch=16ms@1s", "burst=30*0.01%@500ms+1s". Times are decimal
/// numbers with ns, us, ms, s or min behind them (a bare 0 needs none); docs/sim.md has it all.
/// Independent of the locale. Throws nothing but std::bad_alloc.
[[nodiscard]] G4LIDAR_API std::variant<fault, fault_error> parse_fault(std::string_view text);

}  // namespace g4lidar::sim
