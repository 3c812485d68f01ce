// SPDX-License-Identifier: MIT
// A response_view of temporary bytes would dangle: it does not compile.
// expect: deleted function.*response_view::from|call to deleted function 'from'
#include <cstdint>
#include <vector>

#include "g4lidar/core/response.hpp"

std::vector<std::uint8_t> read_a_reply();

bool misuse() {
#ifdef MISUSE
  const auto reply = g4lidar::response_view::from(read_a_reply());
#else
  const std::vector<std::uint8_t> data = read_a_reply();
  const auto reply = g4lidar::response_view::from(data);
#endif
  return reply.has_value();
}
