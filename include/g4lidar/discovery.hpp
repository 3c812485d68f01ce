// SPDX-License-Identifier: MIT
// Discovery: which serial ports there are, which appear and disappear, and which lidar is attached to them.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/transport/recognition.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// What the system knows about a serial port, without opening it. Empty or 0 where not known.
struct port_info {
  std::string path;          ///< "/dev/ttyUSB0"
  std::string by_id;         ///< "/dev/serial/by-id/..."; only udevd creates it.
  std::string bus_path;      ///< The USB port, "1-1.4": the bus, then the port of each hub.
  std::string usb_serial;    ///< Of the USB bridge, not of the lidar: often "0001" on all of them.
  std::string manufacturer;  ///< As the USB bridge reports it.
  std::string product;
  std::string driver;           ///< The kernel driver, "cp210x".
  std::uint16_t vendor_id = 0;  ///< USB, 0x10c4 for Silicon Labs.
  std::uint16_t product_id = 0;
  bool may_open = false;  ///< Whether this user may read and write it.
  std::string holder;     ///< See find_holders().

  friend bool operator==(const port_info&, const port_info&) = default;
};

/// Every serial port, ordered by path. Works without udevd: then by_id is empty, and the names come
/// from the USB bridge instead of the data base of udev. *Allocates.* Fails with system.
/// If the environment variable G4LIDAR_SIM_DIR names a directory, the simulated lidars in it
/// (symbolic links to pseudo-terminals that a simulator serves, as `g4-dump sim --register` creates
/// them) are listed as ports of a G4. Everything else in it is ignored.
[[nodiscard]] G4LIDAR_API result<std::vector<port_info>> list_ports();

/// Writes to each port which process has it open, "screen (1234)", as far as this user may see it:
/// only root may see the processes of other users. Examines all processes, which takes some 10 ms.
/// *Allocates.*
G4LIDAR_API void find_holders(std::span<port_info> ports);

/// Whether the USB bridge of the port is the model that comes with a G4: a CP2102, USB 10c4:ea60.
/// Other lidars of the same manufacturer use 0483:5740 (STM32) and 067b:2303 (PL2303); these are
/// not included. A CP2102 may also belong to any other device. *Never waits.*
[[nodiscard]] G4LIDAR_API bool is_g4_bridge(const port_info& port) noexcept;

/// Whether nothing is written to the port unless the user names it, whatever the options are: a console of this
/// computer, the port of a login (`holder`), a Bluetooth port. Reads a file of the system. *Allocates.*
[[nodiscard]] G4LIDAR_API bool is_reserved(const port_info& port);

/// The USB bridge of the port as people know it: "FT231X", "CH340", "UART" of a port that is no USB device. *Allocates.*
[[nodiscard]] G4LIDAR_API std::string bridge_of(const port_info& port);

/// A port that appeared or disappeared.
struct port_event {
  bool plugged;    ///< True: appeared. False: disappeared.
  port_info port;  ///< After an unplug: as last known.
};

/// Reports ports that appear and disappear. *Single thread.* It listens to udevd if udevd runs,
/// because then the links and permissions of a port are complete when it is reported; otherwise to
/// the kernel. In a container without access to both, it never reports anything: call list_ports()
/// from time to time there.
class G4LIDAR_API port_monitor {
 public:
  /// Begins to listen; ports that appear from now on are reported. *Allocates.* Fails with system.
  [[nodiscard]] static result<port_monitor> open();

  port_monitor(port_monitor&&) noexcept;
  port_monitor& operator=(port_monitor&&) noexcept;
  ~port_monitor();

  /// For poll(): readable when next() may have an event.
  [[nodiscard]] int native_handle() const noexcept;

  /// The next event; nothing if there is none now. *Never waits*; allocates.
  [[nodiscard]] std::optional<port_event> next();

 private:
  struct state;
  explicit port_monitor(std::unique_ptr<state> made) noexcept;
  std::unique_ptr<state> state_;
};

/// A lidar, as far as its bytes name it.
struct recognised_lidar {
  const g4lidar::model* model = nullptr;  ///< The most usual of `candidates`. Valid forever.
  std::uint32_t baud = 0;                 ///< Of the port; 0 where bytes take no time.
  /// As it reported; is_known() is false for one-way lidars that report nothing, or whose model was named.
  device_information device{};
  bool was_scanning = false;  ///< Packets arrived. A two-way lidar was stopped.
  /// All models between which the bytes do not decide, `model` first: an X2 and an X3 send the same.
  std::vector<const g4lidar::model*> candidates{};
  known_by by = known_by::nothing;  ///< From what `model` is known.
  /// Its packets are those of a two-way lidar, and it does not answer: it can be read only.
  bool is_silent = false;
  bool speaks_telnet = false;  ///< As recognition::speaks_telnet.
};

/// What is known before a search.
struct search_options {
  const g4lidar::model* model =
      nullptr;  ///< Not searched for if it is set: its rates are tried first. A one-way one gets no byte.
  std::uint32_t baud = 0;    ///< Not searched for if it is not 0.
  bool listen_only = false;  ///< Not a byte is sent.
  bool leave_dtr = false;    ///< The line DTR is not set: lidar_options::leave_dtr.
  /// Whether the user has named the port: if nothing arrives, DTR gets a pulse, because some models need
  /// it to turn. Takes 2 s more.
  bool may_pulse_dtr = false;
  /// Called about every 50 ms while it listens, if it is set; true ends the search with cancelled.
  std::function<bool()> is_cancelled{};
};

/// Finds out which lidar is attached to an open port, and at which rate it sends. Listens, and where it is
/// silent asks for the device information: two bytes that change nothing. Only a stream of packets that a
/// two-way lidar may send is stopped. Leaves a two-way lidar idle, and the port at the rate that was
/// found. Takes about 0.1 s with an idle G4, at most 3 s with another lidar, and 4 s at a rate that no model has; where nothing answers or
/// sends, as long as the deadline allows. Returns by the deadline, in the clock of the transport's now_ns().
/// *Allocates.*
///
/// Fails with silence, garbage (bytes arrived, but no packet and no answer), other_device (a product that is
/// not supported, or packets that cannot be those of the named model; the subject names them), or like the transport. The subject of silence and
/// garbage has the rates, and that of garbage states how many bytes arrived and how they begin.
[[nodiscard]] G4LIDAR_API result<recognised_lidar> search(transport& port, std::int64_t deadline_ns,
                                                          const search_options& options = {});

/// A port with the lidar that is attached to it.
struct found_lidar {
  port_info port;
  recognised_lidar lidar;
};

/// How lidars are searched.
struct find_options {
  /// Write to every serial port, also to ports without the USB bridge of a G4. Commands of two bytes each
  /// are then sent to any device, at several rates: a printer, a modem, a robot arm. Not to ports that is_reserved() is
  /// true for, and not to those that a process has open, as far as this user sees it.
  bool probe_all_ports = false;
  std::uint32_t baud = 0;                         ///< 0: all that lidars have.
  bool listen_only = false;                       ///< As search_options::listen_only.
  std::chrono::milliseconds probe_timeout{4000};  ///< For each port.
};

/// Every lidar that answers or sends, ordered by path. Opens the ports one after the other and restores their
/// settings; skips those that cannot be opened or where no lidar is found. Takes at most
/// `probe_timeout` a port. *Allocates.* Fails with system.
[[nodiscard]] G4LIDAR_API result<std::vector<found_lidar>> find_lidars(
    const find_options& options = {});

/// The port that `name` names. Writes to ports only where stated:
/// - "/dev/...", or any path: that port; only its path is set;
/// - "usb:1-1.4": the port at that USB port;
/// - "serial:2021101000070073": the port at which the lidar with this number answers (writes);
/// - "": the port of the only lidar. With one USB bridge of a G4, its port; with several, they are
///   searched (writes), and one that cannot be searched counts as one with a lidar.
///
/// The path is not opened and need not exist. Fails with bad_option (also for what looks like a misspelled name:
/// "ttyUSB0", "COM3", "udp:HOST:PORT", "HOST:PORT"; the subject has the right one), no_port (the subject lists the
/// ports that were not looked at), several_ports (the subject lists them), or system; for "serial:" also with permission or busy, if that prevented
/// the query of a port and no other lidar has that number.
[[nodiscard]] G4LIDAR_API result<port_info> select_port(std::string_view name,
                                                        const find_options& options = {});

}  // namespace g4lidar
