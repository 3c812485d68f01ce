// SPDX-License-Identifier: MIT
// The whole core, instantiated: what this translation unit needs from outside is what the core needs.
#include "g4lidar/stream_parser.hpp"

namespace {

struct sink {
  std::size_t* bytes;
  void operator()(const g4lidar::event& found) const {
    if (const auto* gone = std::get_if<g4lidar::skipped>(&found)) *bytes += gone->count;
  }
};

}  // namespace

std::size_t use_parser(g4lidar::stream_parser& parser, g4lidar::bytes input);
std::size_t use_parser(g4lidar::stream_parser& parser, g4lidar::bytes input) {
  std::size_t count = 0;
  parser.feed(input, sink{&count});
  while (const auto found = parser.finish()) sink{&count}(*found);
  return count;
}
