// SPDX-License-Identifier: MIT
// The other end of a pty: a simulated G4 at the rate of a real connection, then packets without a
// rate limit.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/sim/device.hpp"

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
  int slave_ = -1;  // kept open, so that the pty does not hang up between two users
  std::string path_;
};

/// From now on this thread runs on that processor alone, if the machine has it. A real lidar takes no time of the
/// program's processor.
void use_processor(unsigned number) noexcept;

/// Runs a G4 on the master until `end_ns`. Stores in `zero_packets_ns` when each complete zero
/// packet was about to be written.
void feed_in_real_time(int master, std::int64_t end_ns, std::vector<std::int64_t>& zero_packets_ns);

/// Runs a G4 until it has been started; then writes `stream` repeatedly, as fast as the pty accepts
/// it, `bytes_wanted` in total.
void flood(int master, const std::vector<std::uint8_t>& stream, std::size_t bytes_wanted);

/// Packets of `revolutions` whole revolutions, and the number of their samples.
struct recording {
  std::vector<std::uint8_t> data;
  std::size_t samples = 0;
};
[[nodiscard]] recording record(std::size_t revolutions);

}  // namespace g4lidar::bench
