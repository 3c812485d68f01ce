// SPDX-License-Identifier: MIT
// Decides which requests are accepted: those of pages of this server, and of programs that are not browsers. Any
// web page can open a connection to loopback, and any name can resolve to it (DNS rebinding).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace g4_tool {

/// *Any thread.*
class host_guard {
 public:
  /// `address`: where the server listens. `origins`: other allowed origins, such as
  /// https://app.foxglove.dev. With 0.0.0.0 and :: every numeric address is accepted as a name of this
  /// machine, and so is its host name, alone and with .local.
  host_guard(std::string_view address, std::vector<std::string> origins);

  /// `host` and `origin`: the headers of a request, if it has them. Programs that are not browsers send no
  /// origin. Returns why the request is refused, without a full stop; empty if it is accepted.
  [[nodiscard]] std::string objection(const std::optional<std::string>& host,
                                      const std::optional<std::string>& origin) const;
  [[nodiscard]] bool allows(const std::optional<std::string>& host,
                            const std::optional<std::string>& origin) const {
    return objection(host, origin).empty();
  }

 private:
  [[nodiscard]] bool is_own(std::string_view name) const;

  bool is_any_address_;
  std::vector<std::string> names_;
  std::vector<std::string> origins_;
};

/// The hosts for URLs of a server that listens at `address`; for 0.0.0.0 and :: the name and the addresses
/// of this machine. Never empty.
[[nodiscard]] std::vector<std::string> hosts_of(const std::string& address);

}  // namespace g4_tool
