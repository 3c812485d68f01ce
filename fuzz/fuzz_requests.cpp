// SPDX-License-Identifier: MIT
// What clients of g4-serve send: texts of the page and of Foxglove, and the headers Host and Origin.
//
// The input is lines. The first two are Host and Origin; each further one is a text of both clients.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "client_registry.hpp"
#include "host_guard.hpp"

namespace {

using namespace g4_tool;

void expect(bool holds, const char* otherwise) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", otherwise);
  std::abort();
}

/// Up to the next line feed, or the end.
std::string_view take_line(std::string_view& rest) {
  const std::string_view line = rest.substr(0, rest.find('\n'));
  rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  return line;
}

void check_names(const std::string& host, const std::string& origin) {
  const host_guard guard("127.0.0.1", {"https://app.foxglove.dev"});
  if (!guard.allows(host, std::nullopt)) return;
  std::string small = host;
  for (char& c : small) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  bool is_loopback = false;
  for (const char* const own : {"127.0.0.1", "localhost", "[::1]"}) {
    is_loopback |= small == own || small.starts_with(std::string(own) + ':');
  }
  expect(is_loopback, "a name that is not of this machine is allowed");
  if (!guard.allows(host, origin)) return;
  expect(origin == "https://app.foxglove.dev" || origin.find("127.0.0.1") != std::string::npos ||
             origin.find("localhost") != std::string::npos ||
             origin.find("[::1]") != std::string::npos,
         "a page of somebody else is allowed");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  const std::string host(take_line(rest));
  const std::string origin(take_line(rest));
  check_names(host, origin);

  std::vector<std::function<void(const std::string&)>> unanswered;
  const auto set = [&unanswered](const set_request& wanted, auto done) {
    expect(!wanted.name.empty() || !wanted.value.empty(), "an empty setting");
    unanswered.push_back(std::move(done));
  };
  const auto play = [](const play_request& wanted) {
    expect(!wanted.speed || *wanted.speed == *wanted.speed, "a speed that is no number");
    expect(!wanted.seek_s || *wanted.seek_s == *wanted.seek_s, "a place that is no number");
  };
  client_registry registry("session", true, {set, play}, [] {});
  client_registry::client* clients[] = {registry.connect(client_kind::page, nullptr),
                                        registry.connect(client_kind::foxglove, nullptr)};
  while (!rest.empty()) {
    const std::string_view text = take_line(rest);
    for (client_registry::client*& each : clients) {
      if (each == nullptr || registry.receive(*each, text)) continue;
      registry.disconnect(each);
      each = nullptr;
    }
    registry.publish(channel::scan, 1, std::vector<std::uint8_t>(8));
    expect(unanswered.size() < 2, "a client sets twice at once");
  }
  for (const auto& done : unanswered) done("it is over");
  for (client_registry::client* const each : clients) {
    if (each == nullptr) continue;
    unsigned waiting = 0;
    while (registry.take(*each)) ++waiting;
    expect(waiting <= outbox::longest_queue + outbox::slot_count, "more waits than has room");
    registry.disconnect(each);
  }
  expect(registry.client_count() == 0, "a client is left");
  return 0;
}
