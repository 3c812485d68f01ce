// SPDX-License-Identifier: MIT
#include "listening_connector.hpp"

#include <array>
#include <variant>

#include "g4lidar/stream_parser.hpp"

namespace g4_dump {
namespace {

/// Whether a packet comes. What goes wrong will go wrong for the driver, too, and be told by it.
bool hears_packet(g4lidar::transport& line, std::int64_t deadline_ns) {
  g4lidar::stream_parser parser;
  std::array<std::uint8_t, 1024> buffer;
  bool found = false;
  while (!found && line.now_ns() < deadline_ns) {
    const auto got = line.read(buffer, deadline_ns);
    if (!got || got->count == 0) return false;
    parser.feed(g4lidar::bytes(buffer).first(got->count), [&found](const g4lidar::event& what) {
      found = found || std::holds_alternative<g4lidar::packet_view>(what);
    });
  }
  return found;
}

}  // namespace

g4lidar::result<std::unique_ptr<g4lidar::transport>> listening_connector::connect() noexcept {
  auto line = lines_->connect();
  if (line && (*line)->answers() && hears_packet(**line, lines_->now_ns() + listen_ns)) {
    heard_ = true;
  }
  return line;
}

}  // namespace g4_dump
