// SPDX-License-Identifier: MIT
// Which serial ports there are, which of them come and go, and behind which of them a G4 answers.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/error.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/response.hpp"
#include "g4lidar/transport.hpp"

namespace g4lidar {

/// What the system knows of a serial port, without opening it. Empty or 0 where it does not say.
struct port_info {
  std::string path;          ///< "/dev/ttyUSB0"
  std::string by_id;         ///< "/dev/serial/by-id/...", which only udevd makes.
  std::string bus_path;      ///< The USB place, "1-1.4": bus, then the ports on the way.
  std::string usb_serial;    ///< Of the bridge, not of the lidar: often "0001" on all of them.
  std::string manufacturer;  ///< As the bridge calls itself.
  std::string product;
  std::string driver;           ///< The kernel's, "cp210x".
  std::uint16_t vendor_id = 0;  ///< USB, 0x10c4 for Silicon Labs.
  std::uint16_t product_id = 0;
  bool may_open = false;  ///< This user may read and write it.
  std::string holder;     ///< See find_holders().

  friend bool operator==(const port_info&, const port_info&) = default;
};

/// Every serial port, ordered by path. Works without udevd: what it would add (by_id, and the names
/// out of its data base) is then empty or comes from the bridge itself. *Allocates.*
/// Fails with system.
[[nodiscard]] G4LIDAR_API result<std::vector<port_info>> list_ports();

/// Says in each port who has it open, "screen (1234)", as far as this user may see that: the programs
/// of others only root may. Looks through all processes, some ten milliseconds. *Allocates.*
G4LIDAR_API void find_holders(std::span<port_info> ports);

/// Whether the port is behind the bridge that comes with a G4: a CP2102, USB 10c4:ea60. Other lidars
/// of the maker come behind 0483:5740 (STM32) and 067b:2303 (PL2303) too; those are not counted, and
/// a CP2102 can be in front of anything. *Never waits.*
[[nodiscard]] G4LIDAR_API bool is_g4_bridge(const port_info& port) noexcept;

/// A port that came or went.
struct port_event {
  bool plugged;    ///< Else unplugged.
  port_info port;  ///< For one that went: as it was last known.
};

/// Tells of ports that come and go. *Single thread.* It listens to udevd where that runs, for then a
/// port's links and permissions are right when it is told; else to the kernel. In a container that is
/// given neither, nothing is ever told: call list_ports() from time to time there.
class G4LIDAR_API port_monitor {
 public:
  /// Begins to listen; ports that come from now on are told. *Allocates.* Fails with system.
  [[nodiscard]] static result<port_monitor> open();

  port_monitor(port_monitor&&) noexcept;
  port_monitor& operator=(port_monitor&&) noexcept;
  ~port_monitor();

  /// For poll(): readable when next() may have something to tell.
  [[nodiscard]] int native_handle() const noexcept;

  /// The next event, or nothing for now. *Never waits*; allocates.
  [[nodiscard]] std::optional<port_event> next();

 private:
  struct state;
  explicit port_monitor(std::unique_ptr<state> made) noexcept;
  std::unique_ptr<state> state_;
};

/// Asks who is there: stops a scan that may be running, waits until the line is silent, asks for the
/// device information. Leaves the device idle. About 0.1 s where a G4 is idle; returns by the
/// deadline, of the transport's now_ns().
///
/// Fails with silence, garbage (bytes came, and no answer among them), other_device (it answers, and
/// is no G4), does_not_stop, or as the transport does.
[[nodiscard]] G4LIDAR_API result<device_information> probe(transport& port,
                                                           std::int64_t deadline_ns);

/// A port, and the lidar behind it.
struct found_lidar {
  port_info port;
  device_information device;
};

/// How lidars are looked for.
struct find_options {
  /// Write to every serial port, also to those that no G4's bridge is in front of. Two commands of two
  /// bytes each are sent to whatever is there: a printer, a modem, a robot's arm.
  bool probe_all_ports = false;
  std::uint32_t baud = 230400;
  std::chrono::milliseconds probe_timeout{2500};  ///< For each port.
};

/// Every G4 that answers, ordered by path. Opens the ports one after the other and leaves them as
/// they were; those that cannot be opened, or where no G4 answers, are passed over. *Allocates.*
/// Fails with system.
[[nodiscard]] G4LIDAR_API result<std::vector<found_lidar>> find_lidars(
    const find_options& options = {});

/// The one port that `which` means; where it can be told without, no port is written to:
/// - "/dev/...", or any path: that port, of which nothing else is then told;
/// - "usb:1-1.4": the port at that USB place;
/// - "serial:2021101000070073": the port behind which the lidar with this number answers;
/// - "": the port of the only G4. Where one bridge is plugged, it is that; where there are several,
///   they are asked, and one that cannot be asked counts as a G4.
///
/// The path is not opened and need not exist: opening it will tell. Fails with bad_option, no_port,
/// several_ports (the subject lists them), or system; with serial: also with permission or busy, if
/// that kept a port from being asked and no other has that number.
[[nodiscard]] G4LIDAR_API result<port_info> select_port(std::string_view which,
                                                        const find_options& options = {});

}  // namespace g4lidar
