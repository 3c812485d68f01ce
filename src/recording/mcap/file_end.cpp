// SPDX-License-Identifier: MIT
#include "file_end.hpp"

#include <algorithm>
#include <cstddef>

namespace g4lidar::mcap {
namespace {

constexpr std::uint64_t first_part = std::uint64_t{256} << 10U;
constexpr std::uint64_t largest_part = 2 * largest_chunk;
constexpr std::size_t most_chunks = 8;

/// In the end of a file: positions in `part`, the last one first.
std::vector<std::size_t> chunks_in(bytes part) {
  std::vector<std::size_t> found;
  for (std::size_t at = 0; at < part.size();) {
    const auto header = believe(part.subspan(at), part.size() - at);
    const bool is_chunk = header && header->kind == opcode::chunk;
    if (is_chunk) found.push_back(at);
    if (header && !found.empty()) {  // before the first chunk this may be the middle of a record
      at += record_header_size + static_cast<std::size_t>(header->length);
      continue;
    }
    const auto rest = part.subspan(at + 1);
    const auto next = std::ranges::find(rest, static_cast<std::uint8_t>(opcode::chunk));
    at += 1 + static_cast<std::size_t>(next - rest.begin());
  }
  std::ranges::reverse(found);
  found.resize(std::min(found.size(), most_chunks));
  return found;
}

}  // namespace

std::vector<std::uint64_t> last_chunks(byte_source& file) {
  std::vector<std::uint8_t> part;
  std::vector<std::uint64_t> found;
  std::uint64_t size = 0;
  for (std::uint64_t wanted = first_part; wanted <= largest_part; wanted *= 4) {
    if (size == file.size()) break;
    size = std::min(wanted, file.size());
    part.resize(static_cast<std::size_t>(size));
    const std::uint64_t begin = file.size() - size;
    part.resize(file.read(begin, part));
    for (const std::size_t at : chunks_in(part)) found.push_back(begin + at);
    if (!found.empty()) break;
  }
  return found;
}

}  // namespace g4lidar::mcap
