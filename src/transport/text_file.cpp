// SPDX-License-Identifier: MIT
#include "transport/text_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include "transport/owned_fd.hpp"

namespace g4lidar {

std::string read_text_file(const std::string& path, std::string& text) {
  constexpr std::size_t most_bytes = std::size_t{16} << 20U;
  const auto unreadable = [] {
    return "cannot be read: " + std::generic_category().message(errno);
  };
  constexpr int flags = O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC;  // it may be a pipe
  const owned_fd in(::open(path.c_str(), flags));
  struct stat file{};
  if (!in || ::fstat(in.get(), &file) != 0) return unreadable();
  if (S_ISDIR(file.st_mode)) return "is a directory";
  if (!S_ISREG(file.st_mode)) return "is a pipe or a device, not a file";
  std::array<char, 16'384> part;
  while (const ssize_t count = ::read(in.get(), part.data(), part.size())) {
    if (count < 0) return unreadable();
    text.append(part.data(), static_cast<std::size_t>(count));
    if (text.size() > most_bytes) return "is longer than 16 MB";
  }
  return {};
}

}  // namespace g4lidar
