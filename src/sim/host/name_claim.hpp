// SPDX-License-Identifier: MIT
// Names that a running simulator holds. The kernel frees them when its process ends, however it ends.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <string>
#include <string_view>

#include "transport/owned_fd.hpp"

namespace g4lidar::sim {

/// The directory of registered ports; empty where there is none.
inline std::string registry() {
  const char* const directory = std::getenv("G4LIDAR_SIM_DIR");
  return directory == nullptr ? "" : directory;
}

/// The abstract socket of a name: of a link, or of a pseudo-terminal that a simulator serves.
class name_claim {
 public:
  explicit name_claim(std::string_view name) noexcept {
    constexpr std::string_view prefix = "g4lidar-sim-";
    address_.sun_family = AF_UNIX;
    char* const begin = std::copy(prefix.begin(), prefix.end(), address_.sun_path + 1);
    const auto room = static_cast<std::size_t>(std::end(address_.sun_path) - begin);
    name = name.substr(0, room);
    const char* const end = std::copy(name.begin(), name.end(), begin);
    size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path)) +
            static_cast<socklen_t>(end - address_.sun_path);
  }

  /// Holds the name as long as the handle is open. Empty where another process holds it: EADDRINUSE.
  [[nodiscard]] owned_fd hold() const noexcept {
    owned_fd held = socket();
    if (!held || ::bind(held.get(), generic(), size_) != 0) return {};
    return held;
  }
  [[nodiscard]] bool is_held() const noexcept {
    const owned_fd visitor = socket();
    return visitor && ::connect(visitor.get(), generic(), size_) == 0;
  }

 private:
  static owned_fd socket() noexcept {
    return owned_fd(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  }
  [[nodiscard]] const sockaddr* generic() const noexcept {
    return reinterpret_cast<const sockaddr*>(&address_);
  }

  sockaddr_un address_{};
  socklen_t size_ = 0;
};

}  // namespace g4lidar::sim
