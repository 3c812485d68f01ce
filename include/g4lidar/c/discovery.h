/* SPDX-License-Identifier: MIT */
/**
 * @file
 * Discovery: which serial ports there are, which appear and disappear, and which lidar is attached.
 */
#ifndef G4LIDAR_C_DISCOVERY_H
#define G4LIDAR_C_DISCOVERY_H

#include "g4lidar/c/lidar.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What is known about a serial port. A view; texts are empty and numbers 0 where it is not known. */
typedef struct g4lidar_port {
  const char* path;         /**< "/dev/ttyUSB0" */
  const char* by_id;        /**< "/dev/serial/by-id/..." */
  const char* bus_path;     /**< The USB port, "1-1.4". */
  const char* usb_serial;   /**< Of the USB bridge, not of the lidar. */
  const char* manufacturer; /**< As the USB bridge reports it. */
  const char* product;      /**< As the USB bridge reports it. */
  const char* driver;       /**< The kernel driver, "cp210x". */
  const char* holder;       /**< Which process has it open, "screen (1234)"; see `find_holders`. */
  uint16_t vendor_id;       /**< USB, 0x10c4 for Silicon Labs. */
  uint16_t product_id;      /**< USB. */
  bool may_open;            /**< Whether this user may read and write it. */
  bool is_g4_bridge;        /**< Whether its USB bridge is the model that comes with a G4. */
  bool has_lidar;           /**< Whether g4lidar_find_lidars() has found a lidar. */
  g4lidar_identity lidar;   /**< As it reported; 0 where it reports nothing. */
  const char* model;        /**< The model that was found, "x2"; see `candidates`. */
  const char* candidates;   /**< All models that send the same bytes: "x2, x2l, x3". */
  uint32_t baud;            /**< The rate at which it was found. */
} g4lidar_port;

/** A list of ports. */
typedef struct g4lidar_ports g4lidar_ports;

/** How ports and lidars are searched. */
typedef struct g4lidar_find_options {
  size_t struct_size;       /**< Set by g4lidar_find_options_init(). */
  uint32_t baud;            /**< Bits per second; 0: all that lidars have. */
  int32_t probe_timeout_ms; /**< For each port; 4000. */
  /** Write to every serial port, also to ports without the USB bridge of a G4. Commands of two bytes
   *  each are then sent to any device, at several rates: a printer, a modem, a robot arm. */
  bool probe_all_ports;
  bool find_holders;   /**< Find out which process has each port open: takes some 10 ms. */
  uint8_t reserved[6]; /**< 0. */
} g4lidar_find_options;

/** Sets the defaults; `size` is sizeof(g4lidar_find_options). */
G4LIDAR_C_API void g4lidar_find_options_init(g4lidar_find_options* options, size_t size);

/** Lists all serial ports, ordered by path, and writes to none. `options` may be NULL, here and below. */
G4LIDAR_C_API int g4lidar_list_ports(const g4lidar_find_options* options, g4lidar_ports** ports,
                                     g4lidar_error* error);
/** Lists the ports at which a lidar answers or sends: opens them one after the other. Takes at most
 *  `probe_timeout_ms` for each port. */
G4LIDAR_C_API int g4lidar_find_lidars(const g4lidar_find_options* options, g4lidar_ports** ports,
                                      g4lidar_error* error);
/** The port that `name` names as in g4lidar_options: a list of one. Fails with no_port, several_ports,
 *  bad_option, system; for "serial:" also with permission or busy. */
G4LIDAR_C_API int g4lidar_select_port(const char* name, const g4lidar_find_options* options,
                                      g4lidar_ports** ports, g4lidar_error* error);
/** The number of ports. */
G4LIDAR_C_API size_t g4lidar_ports_count(const g4lidar_ports* ports);
/** Port `index`; NULL if there are not as many. Valid as long as the list. */
G4LIDAR_C_API const g4lidar_port* g4lidar_ports_at(const g4lidar_ports* ports, size_t index);
/** Releases a list. */
G4LIDAR_C_API void g4lidar_ports_free(g4lidar_ports* ports);

/** Reports ports that appear and disappear. */
typedef struct g4lidar_port_monitor g4lidar_port_monitor;

/** Begins to listen; ports that appear from now on are reported. In a container without udevd nothing
 *  is ever reported: call g4lidar_list_ports() from time to time there. */
G4LIDAR_C_API int g4lidar_port_monitor_open(g4lidar_port_monitor** monitor, g4lidar_error* error);
/** For poll(): readable when g4lidar_port_monitor_next() may have an event. */
G4LIDAR_C_API int g4lidar_port_monitor_descriptor(const g4lidar_port_monitor* monitor);
/** Takes the next event: the port, and whether it was plugged in (true) or unplugged. G4LIDAR_NOTHING
 *  if there is none. Never waits. */
G4LIDAR_C_API int g4lidar_port_monitor_next(g4lidar_port_monitor* monitor, bool* plugged,
                                            const g4lidar_port** port);
/** Releases a monitor. */
G4LIDAR_C_API void g4lidar_port_monitor_free(g4lidar_port_monitor* monitor);

#ifdef __cplusplus
}
#endif

#endif
