// SPDX-License-Identifier: MIT
// The messages of an unpacked MCAP file, read by the file format's rules (mcap.dev) without the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace g4lidar::test {

/// The messages on this topic, in the order of the file.
inline std::vector<std::vector<std::uint8_t>> mcap_messages(std::string_view file,
                                                            std::string_view topic) {
  const auto number = [](std::string_view text, std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = size; i > 0; --i) {
      value = value << 8U | static_cast<std::uint8_t>(text.at(at + i - 1));
    }
    return value;
  };
  std::map<std::uint64_t, std::string> topics;
  std::vector<std::vector<std::uint8_t>> found;
  const auto read_records = [&](const auto& self, std::string_view rest) -> void {
    while (rest.size() >= 9) {
      const auto operation = static_cast<std::uint8_t>(rest[0]);
      const std::string_view content = rest.substr(9).substr(0, number(rest, 1, 8));
      if (operation == 4) {  // Channel: id, schema, topic
        topics[number(content, 0, 2)] = content.substr(8, number(content, 4, 4));
      } else if (operation == 5) {  // Message: channel, sequence, log and publish time, data
        const std::string_view data = content.substr(22);
        if (topics[number(content, 0, 2)] == topic) found.emplace_back(data.begin(), data.end());
      } else if (operation == 6) {  // Chunk: times, size, checksum, compression, records
        const std::size_t name_size = number(content, 28, 4);
        if (name_size != 0) throw std::runtime_error("the chunk is packed");
        self(self, content.substr(40 + name_size, number(content, 32 + name_size, 8)));
      }
      rest.remove_prefix(9 + content.size());
    }
  };
  read_records(read_records, file.substr(8));
  return found;
}

}  // namespace g4lidar::test
