// SPDX-License-Identifier: MIT
#include "host_guard.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "cli/suggestion.hpp"

namespace g4_tool {
namespace {

bool is_in_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '_';
}
bool is_in_ipv6(char c) {
  return (c >= 'a' && c <= 'f') || (c >= '0' && c <= '9') || c == ':' || c == '.';
}

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return {};
  return lowered(std::string_view(name.data()));
}

/// "[::1]" of "[::1]:8765", "localhost" of "LocalHost": in lower case, without the port; nothing if it is
/// malformed.
std::optional<std::string> name_in_host(std::string_view host) {
  constexpr std::size_t longest = 255;
  if (host.empty() || host.size() > longest) return std::nullopt;
  const bool is_ipv6 = host.front() == '[';
  const std::size_t end = is_ipv6 ? host.find(']') : host.find(':');
  if (is_ipv6 && end == std::string_view::npos) return std::nullopt;
  const std::size_t length = is_ipv6 ? end + 1 : std::min(end, host.size());
  std::string name = lowered(host.substr(0, length));
  const std::string_view port = host.substr(length);
  const bool is_port =
      port.empty() ||
      (port.size() >= 2 && port.size() <= 6 && port.front() == ':' &&
       std::ranges::all_of(port.substr(1), [](char c) { return c >= '0' && c <= '9'; }));
  const bool is_name =
      is_ipv6 ? std::ranges::all_of(std::string_view(name).substr(1, name.size() - 2), is_in_ipv6)
              : !name.empty() && std::ranges::all_of(name, is_in_name);
  if (!is_port || !is_name) return std::nullopt;
  return name;
}

/// Whether it is a numeric address, IPv6 in brackets.
bool is_numeric(std::string_view name) {
  std::array<unsigned char, 16> address{};
  if (name.starts_with('[') && name.ends_with(']')) {
    return ::inet_pton(AF_INET6, std::string(name.substr(1, name.size() - 2)).c_str(),
                       address.data()) == 1;
  }
  return ::inet_pton(AF_INET, std::string(name).c_str(), address.data()) == 1;
}

/// Whether it has the form of an origin in a browser: SCHEME://HOST or SCHEME://HOST:PORT.
bool is_origin(std::string_view text) {
  const std::size_t colon = text.find("://");
  if (colon == std::string_view::npos || colon == 0) return false;
  const std::string_view scheme = text.substr(0, colon);
  const auto is_in_scheme = [](char c) { return (c >= 'a' && c <= 'z') || c == '-' || c == '+'; };
  return std::ranges::all_of(scheme, is_in_scheme) &&
         (text.size() == colon + 3 || name_in_host(text.substr(colon + 3)).has_value());
}

}  // namespace

host_guard::host_guard(std::string_view address, std::vector<std::string> origins)
    : is_any_address_(address == "0.0.0.0" || address == "::"),
      names_{"localhost", "127.0.0.1", "[::1]"},
      origins_(std::move(origins)) {
  const bool is_ipv6 = address.find(':') != std::string_view::npos;
  names_.push_back(is_ipv6 ? '[' + lowered(address) + ']' : lowered(address));
  for (std::string& origin : origins_) {
    origin = lowered(origin);
    // A proxy may send its own name as host.
    if (const auto name = name_in_host(origin.substr(origin.find("://") + 3))) {
      names_.push_back(*name);
    }
  }
  if (!is_any_address_) return;
  if (const std::string name = host_name(); !name.empty()) {
    names_.push_back(name);
    names_.push_back(name + ".local");
  }
}

bool host_guard::is_own(std::string_view name) const {
  return std::ranges::count(names_, name) > 0 || (is_any_address_ && is_numeric(name));
}

std::string host_guard::objection(const std::optional<std::string>& host,
                                  const std::optional<std::string>& origin) const {
  if (!host) return "refused a request without the header Host";
  const auto name = name_in_host(*host);
  if (!name) return "refused a request whose header Host is no name";
  if (!is_own(*name)) {
    return fmt::format("refused a request to {}; allow it with --allow-origin http://{}", *name,
                       *name);
  }
  if (!origin) return {};
  const std::string from = lowered(*origin);
  if (from == "http://" + lowered(*host) || std::ranges::count(origins_, from) > 0) return {};
  if (!is_origin(from)) return "refused a web page without an origin";
  return fmt::format("refused a web page of {}; allow it with --allow-origin {}", from, from);
}

std::vector<std::string> hosts_of(const std::string& address) {
  const bool is_ipv6 = address.find(':') != std::string::npos;
  if (address != "0.0.0.0" && address != "::") {
    return {is_ipv6 ? '[' + address + ']' : address};
  }
  std::vector<std::string> found;
  if (std::string name = host_name(); !name.empty()) found.push_back(std::move(name));
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) all = nullptr;
  for (const ifaddrs* each = all; each != nullptr; each = each->ifa_next) {
    if ((each->ifa_flags & IFF_UP) == 0 || (each->ifa_flags & IFF_LOOPBACK) != 0) continue;
    if (each->ifa_addr == nullptr) continue;
    std::array<char, INET6_ADDRSTRLEN> text{};
    if (each->ifa_addr->sa_family == AF_INET) {
      const auto* const place = reinterpret_cast<const sockaddr_in*>(each->ifa_addr);
      ::inet_ntop(AF_INET, &place->sin_addr, text.data(), text.size());
      found.emplace_back(text.data());
    } else if (is_ipv6 && each->ifa_addr->sa_family == AF_INET6) {
      const auto* const place = reinterpret_cast<const sockaddr_in6*>(each->ifa_addr);
      if (IN6_IS_ADDR_LINKLOCAL(&place->sin6_addr)) continue;  // browsers do not take its scope
      ::inet_ntop(AF_INET6, &place->sin6_addr, text.data(), text.size());
      found.push_back('[' + std::string(text.data()) + ']');
    }
  }
  if (all != nullptr) ::freeifaddrs(all);
  if (found.empty()) found.emplace_back("localhost");
  return found;
}

}  // namespace g4_tool
