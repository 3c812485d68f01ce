// SPDX-License-Identifier: MIT
// Which requests come from a page of this server, or from no page at all. A web page of anybody can open
// a connection to loopback, and a name of anybody can lead there (DNS rebinding).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace g4_tool {

/// *Any thread.*
class host_guard {
 public:
  /// `address`: where the server listens. `origins`: further ones that are allowed, such as
  /// https://app.foxglove.dev. With 0.0.0.0 and :: every address in numbers is a name of this machine,
  /// and so is its host name, alone and with .local.
  host_guard(std::string_view address, std::vector<std::string> origins);

  /// `host` and `origin`: the headers of a request; nothing where it has none. Programs that are no
  /// browsers send no origin. Returns what was refused, without a full stop; empty: nothing.
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

/// The names under which others reach a server that listens at `address`, as they stand in a URL; with
/// 0.0.0.0 and :: the name and the addresses of this machine. Never empty.
[[nodiscard]] std::vector<std::string> hosts_of(const std::string& address);
/// "[::1]" of "[::1]:8765", "localhost" of "LocalHost": in small letters, without the port; nothing if
/// it is not well-formed.
[[nodiscard]] std::optional<std::string> name_in_host(std::string_view host);
/// Whether it is an address in numbers, IPv6 in brackets.
[[nodiscard]] bool is_numeric(std::string_view name);
/// Whether it has the form SCHEME://HOST or SCHEME://HOST:PORT, as browsers write it.
[[nodiscard]] bool is_origin(std::string_view text);

}  // namespace g4_tool
