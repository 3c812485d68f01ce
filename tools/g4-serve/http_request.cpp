// SPDX-License-Identifier: MIT
#include "http_request.hpp"

#include <algorithm>
#include <cctype>

namespace g4_tool {
namespace {

constexpr std::string_view line_end = "\r\n";

bool is_same(std::string_view a, std::string_view b) {
  return std::ranges::equal(
      a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t";
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) + 1 - begin);
}

/// Whether it can be a method or the name of a header.
bool is_token(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("!#$%&'*+-.^_`|~").find(static_cast<char>(c)) != std::string_view::npos;
  });
}

bool is_visible(std::string_view text) {
  return std::ranges::all_of(text, [](unsigned char c) { return c > 0x20 && c < 0x7F; });
}

bool is_value(std::string_view text) {
  return std::ranges::all_of(text,
                             [](unsigned char c) { return c == '\t' || (c >= 0x20 && c != 0x7F); });
}

/// Removes and returns the text before the separator, and removes the separator; all if there is none.
std::string_view cut(std::string_view& text, std::string_view separator) {
  const std::size_t at = text.find(separator);
  const std::string_view first = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + separator.size());
  return first;
}

/// False if the member is already set.
bool set(std::string_view& member, std::string_view value) {
  if (!member.empty()) return false;
  member = value;
  return true;
}
bool set(std::optional<std::string>& member, std::string_view value) {
  if (member) return false;
  member = value;
  return true;
}

bool take_header(http_request& into, std::string_view name, std::string_view value) {
  if (is_same(name, "host")) return set(into.host, value);
  if (is_same(name, "origin")) return set(into.origin, value);
  if (is_same(name, "upgrade")) return set(into.upgrade, value);
  if (is_same(name, "connection")) return set(into.connection, value);
  if (is_same(name, "sec-websocket-key")) return set(into.socket_key, value);
  if (is_same(name, "sec-websocket-version")) return set(into.socket_version, value);
  if (is_same(name, "sec-websocket-protocol")) return set(into.subprotocols, value);
  if (is_same(name, "transfer-encoding")) into.has_body = true;
  if (is_same(name, "content-length")) into.has_body = into.has_body || value != "0";
  return true;
}

}  // namespace

bool http_request::wants_socket() const {
  return has_element(upgrade, "websocket") && has_element(connection, "upgrade");
}

bool http_request::keeps_open() const {
  return !is_old && !has_body && !has_element(connection, "close");
}

std::size_t head_size(std::string_view text) {
  const std::size_t at = text.find("\r\n\r\n");
  return at == std::string_view::npos ? 0 : at + 4;
}

std::optional<http_request> parse_head(std::string_view head) {
  std::string_view line = cut(head, line_end);
  http_request made{};
  made.method = cut(line, " ");
  const std::string_view target = cut(line, " ");
  made.path = target.substr(0, target.find('?'));
  made.is_old = line == "HTTP/1.0";
  const bool is_http = made.is_old || line == "HTTP/1.1";
  if (!is_http || !is_token(made.method) || !made.path.starts_with('/') || !is_visible(target)) {
    return std::nullopt;
  }
  while (!(line = cut(head, line_end)).empty()) {
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const std::string_view name = line.substr(0, colon);
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (!is_token(name) || !is_value(value) || !take_header(made, name, value)) return std::nullopt;
  }
  return made;
}

bool has_element(std::string_view list, std::string_view element) {
  while (!list.empty()) {
    if (is_same(trimmed(cut(list, ",")), element)) return true;
  }
  return false;
}

}  // namespace g4_tool
