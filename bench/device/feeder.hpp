// SPDX-License-Identifier: MIT
// The other end of a pty: a simulated G4 at the rate of the line, then a flood of packets.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "g4lidar/sim/device.hpp"
#include "g4lidar/stream_parser.hpp"

namespace g4lidar::bench {

[[nodiscard]] std::int64_t steady_ns() noexcept;

/// A pty, raw, whose other end is `path`.
class pty {
 public:
  pty();
  pty(const pty&) = delete;
  pty& operator=(const pty&) = delete;
  ~pty();
  [[nodiscard]] int master() const noexcept { return master_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  int master_ = -1;
  int slave_ = -1;  // held, so that the line does not hang up between two users
  std::string path_;
};

/// Plays a G4 on the master until `end_ns`. Notes in `zero_packets_ns` when each zero packet was
/// about to be written whole.
void feed_in_real_time(int master, std::int64_t end_ns, std::vector<std::int64_t>& zero_packets_ns);

/// Plays a G4 until it has been started; then writes `stream` again and again, as fast as the pty
/// takes it, `bytes_wanted` in all.
void flood(int master, const std::vector<std::uint8_t>& stream, std::size_t bytes_wanted);

/// Packets of whole revolutions, `revolutions` of them, and how many samples are in them.
struct recording {
  std::vector<std::uint8_t> data;
  std::size_t samples = 0;
};
[[nodiscard]] recording record(std::size_t revolutions);

}  // namespace g4lidar::bench
