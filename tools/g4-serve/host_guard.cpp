// SPDX-License-Identifier: MIT
#include "host_guard.hpp"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

namespace g4_tool {
namespace {

char lowered(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lowered(std::string_view text) {
  std::string made(text);
  std::ranges::transform(made, made.begin(), [](char c) { return lowered(c); });
  return made;
}

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

}  // namespace

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

bool is_numeric(std::string_view name) {
  std::array<unsigned char, 16> address{};
  if (name.starts_with('[') && name.ends_with(']')) {
    return ::inet_pton(AF_INET6, std::string(name.substr(1, name.size() - 2)).c_str(),
                       address.data()) == 1;
  }
  return ::inet_pton(AF_INET, std::string(name).c_str(), address.data()) == 1;
}

bool is_origin(std::string_view text) {
  const std::size_t colon = text.find("://");
  if (colon == std::string_view::npos || colon == 0) return false;
  const std::string_view scheme = text.substr(0, colon);
  const auto is_in_scheme = [](char c) { return (c >= 'a' && c <= 'z') || c == '-' || c == '+'; };
  return std::ranges::all_of(scheme, is_in_scheme) &&
         (text.size() == colon + 3 || name_in_host(text.substr(colon + 3)).has_value());
}

host_guard::host_guard(std::string_view address, std::vector<std::string> origins)
    : is_any_address_(address == "0.0.0.0" || address == "::"),
      names_{"localhost", "127.0.0.1", "[::1]"},
      origins_(std::move(origins)) {
  const bool is_ipv6 = address.find(':') != std::string_view::npos;
  names_.push_back(is_ipv6 ? '[' + lowered(address) + ']' : lowered(address));
  for (std::string& origin : origins_) {
    origin = lowered(origin);
    // A proxy may pass its own name on.
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

bool host_guard::allows(const std::optional<std::string>& host,
                        const std::optional<std::string>& origin) const {
  if (!host) return false;
  const auto name = name_in_host(*host);
  if (!name || !is_own(*name)) return false;
  if (!origin) return true;
  const std::string from = lowered(*origin);
  return from == "http://" + lowered(*host) || std::ranges::count(origins_, from) > 0;
}

}  // namespace g4_tool
