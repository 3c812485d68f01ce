// SPDX-License-Identifier: MIT
// The parser and the reference on any bytes; the bytes also define the pieces.
//
// The input: one byte of flags (bit 0: correct the checksum of each possible header, which a fuzzer
// hardly ever does by itself), one byte with the number of the following piece sizes (0 to 15),
// these sizes, and then the stream.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "g4lidar/core/stream_parser.hpp"
#include "support/reference_parser.hpp"
#include "support/stream_log.hpp"

namespace {

using g4lidar::test::buffer;

void seal_packets(buffer& stream) {
  for (std::size_t at = 0; at + 12 <= stream.size(); ++at) {
    const reference::window in(stream, at);
    if (!reference::could_be_packet(in, 8) || in.left() < 10 + 2 * std::size_t{stream[at + 3]}) {
      continue;
    }
    const int sum = reference::checksum_of(in);
    stream[at + 8] = static_cast<std::uint8_t>(sum & 0xFF);
    stream[at + 9] = static_cast<std::uint8_t>(sum >> 8);
  }
}

/// Parses `stream` in pieces of these sizes, the last one repeated; aborts if the parser breaks a
/// promise.
void read_in_pieces(g4lidar::stream_parser& parser, const buffer& stream,
                    const std::vector<std::size_t>& sizes, const reference::reading& wanted) {
  g4lidar::test::stream_log log(stream);
  std::size_t from = 0;
  for (std::size_t i = 0; from < stream.size(); ++i) {
    const std::size_t size = sizes[std::min(i, sizes.size() - 1)];
    const std::size_t count = std::min(size, stream.size() - from);
    log.feed(parser, count);
    from += count;
  }
  log.finish(parser);
  const std::string complaint = g4lidar::test::difference(log, wanted);
  if (!complaint.empty()) {
    std::fprintf(stderr, "in pieces of %zu ...: %s\n", sizes.front(), complaint.c_str());
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const bool seal = (data[0] & 1U) != 0;
  const std::size_t count = std::min<std::size_t>(data[1] & 15U, size - 2);
  std::vector<std::size_t> sizes(data + 2, data + 2 + count);
  buffer stream(data + 2 + count, data + size);
  if (stream.size() > 20000) return 0;
  if (seal) seal_packets(stream);
  if (sizes.empty() || sizes.back() == 0) sizes.push_back(17);

  const reference::reading wanted = reference::read(stream);
  g4lidar::stream_parser parser;  // one for all: finish() resets it
  read_in_pieces(parser, stream, {stream.size() + 1}, wanted);
  read_in_pieces(parser, stream, sizes, wanted);
  read_in_pieces(parser, stream, {1}, wanted);
  return 0;
}
