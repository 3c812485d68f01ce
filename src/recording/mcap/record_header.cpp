// SPDX-License-Identifier: MIT
#include "record_header.hpp"

#include "chunk_contents.hpp"
#include "record_text.hpp"

namespace g4lidar::mcap {

std::optional<record_header> believe(bytes begin, std::uint64_t left) noexcept {
  if (begin.size() < record_header_size) return std::nullopt;
  const record_header header{static_cast<opcode>(begin[0]), load_u64(begin, 1)};
  if (left < record_header_size || header.length > left - record_header_size) return std::nullopt;
  switch (header.kind) {
    case opcode::chunk:
      if (!chunk_header::from(begin.subspan(record_header_size), header.length))
        return std::nullopt;
      break;
    case opcode::message_index:
      if (header.length < 6 || (header.length - 6) % 16 != 0) return std::nullopt;
      break;
    case opcode::data_end:
      if (header.length != data_end_length) return std::nullopt;
      break;
    case opcode::message:
      if (header.length < message_header_size) return std::nullopt;
      break;
    case opcode::header:
    case opcode::schema:
    case opcode::channel:
    case opcode::attachment:
    case opcode::metadata:
      break;
    default:
      if (begin[0] < 0x80) return std::nullopt;  // otherwise it is an extension of another program
  }
  return header;
}

}  // namespace g4lidar::mcap
