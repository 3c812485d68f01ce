// SPDX-License-Identifier: MIT
// Reads directories; what this user may not see is treated as missing. Not <filesystem>, which
// bypasses the calls that umockdev redirects.
#pragma once

#include <dirent.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <memory>
#include <string>
#include <string_view>

namespace g4lidar {

struct close_directory {
  void operator()(DIR* open) const noexcept { ::closedir(open); }
};

/// Calls `see(name)` for each entry of the directory.
template <class See>
void each_entry(const std::string& path, See see) {
  const std::unique_ptr<DIR, close_directory> open(::opendir(path.c_str()));
  if (!open) return;
  while (const dirent* entry = ::readdir(open.get())) see(std::string_view(entry->d_name));
}

/// The target of a symbolic link; empty for anything else.
inline std::string link_target(const std::string& link) {
  std::array<char, PATH_MAX> target{};
  const ssize_t size = ::readlink(link.c_str(), target.data(), target.size());
  return size > 0 ? std::string(target.data(), static_cast<std::size_t>(size)) : std::string();
}

}  // namespace g4lidar
