// SPDX-License-Identifier: MIT
#include "http_head.hpp"

#include <algorithm>
#include <array>

namespace g4_tool {
namespace {

/// With all clients of the hub they are fewer than the connections that the server has.
constexpr std::size_t most_waiting = 60;
/// A younger one may have sent its request, which was not read yet.
constexpr std::chrono::milliseconds least_age{200};

/// What only the page's own files may do: this keeps foreign texts from becoming programs.
std::string policy_for(const std::string& host) {
  return "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
         "connect-src 'self' ws://" +
         host + "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

}  // namespace

std::optional<std::string> header(lws* wsi, lws_token_indexes which) {
  const int length = lws_hdr_total_length(wsi, which);
  if (length <= 0) return std::nullopt;
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  const int copied = lws_hdr_copy(wsi, text.data(), length + 1, which);
  if (copied < 0) return std::string();  // which is no valid host and no origin
  text.resize(static_cast<std::size_t>(copied));
  return text;
}

bool write_head(lws* wsi, unsigned status, const std::string& type, std::size_t size) {
  std::array<unsigned char, LWS_PRE + 2048> memory{};
  unsigned char* at = memory.data() + LWS_PRE;
  unsigned char* const begin = at;
  unsigned char* const end = memory.data() + memory.size() - 1;
  bool fits = lws_add_http_common_headers(wsi, status, type.c_str(), size, &at, end) == 0;
  const auto add = [&](const char* name, const std::string& value) {
    fits = fits && lws_add_http_header_by_name(wsi, reinterpret_cast<const unsigned char*>(name),
                                               reinterpret_cast<const unsigned char*>(value.data()),
                                               static_cast<int>(value.size()), &at, end) == 0;
  };
  add("cache-control:", "no-store");
  add("x-content-type-options:", "nosniff");
  add("x-frame-options:", "DENY");
  add("referrer-policy:", "no-referrer");
  add("cross-origin-opener-policy:", "same-origin");
  add("cross-origin-resource-policy:", "same-origin");
  if (status == HTTP_STATUS_METHOD_NOT_ALLOWED) add("allow:", "GET, HEAD");
  const bool is_page = status == HTTP_STATUS_OK;  // then the host is a name of ours
  add("content-security-policy:",
      is_page ? policy_for(header(wsi, WSI_TOKEN_HOST).value_or("")) : "default-src 'none'");
  return fits && lws_finalize_write_http_header(wsi, begin, &at, end) == 0;
}

void waiting_connections::add(lws* wsi) {
  const auto now = clock::now();
  all_.push_back({wsi, now});
  if (all_.size() <= most_waiting || now - all_.front().since < least_age) return;
  lws_set_timeout(all_.front().wsi, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_ASYNC);
  all_.pop_front();
}

void waiting_connections::remove(lws* wsi) {
  std::erase_if(all_, [wsi](const entry& each) { return each.wsi == wsi; });
}

}  // namespace g4_tool
