// SPDX-License-Identifier: MIT
#include "network.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <sstream>

#include "cli/logger.hpp"
#include "cli/rows.hpp"

namespace g4_tool::dds {
namespace {

/// The ports of greater domains would overlap with those of others.
constexpr std::uint32_t greatest_domain = 232;
/// The number of processes of a machine to which ROS 2 sends its announcements by unicast.
constexpr int unicast_participants = 32;
/// The number of processes for which the ports of a domain are sufficient.
constexpr int most_participants = 119;

/// In the order of their values.
constexpr std::array<std::string_view, 4> range_names{"SUBNET", "LOCALHOST", "OFF",
                                                      "SYSTEM_DEFAULT"};

discovery_range range_of(const std::string& word) {
  if (word.empty()) return discovery_range::subnet;
  const auto* const found = std::ranges::find(range_names, word);
  if (found != range_names.end()) return static_cast<discovery_range>(found - range_names.begin());
  logger::info(
      fmt::format("ROS_AUTOMATIC_DISCOVERY_RANGE: {} is not one of {}; LOCALHOST is used\n",
                  in_quotes(word), fmt::join(range_names, ", ")));
  return discovery_range::localhost;
}

std::uint32_t domain_of(const std::string& word) {
  try {
    return word.empty() ? 0 : number_of(word, std::uint32_t{0}, greatest_domain);
  } catch (const bad_value& reason) {
    throw bad_value(std::string("ROS_DOMAIN_ID: ") + reason.what());
  }
}

/// `text`, which is safe as a value in the XML of the configuration. Throws bad_value.
std::string checked_name(const std::string& text) {
  const auto is_good = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
           std::string_view(".:-_%/").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::ranges::all_of(text, is_good)) return text;
  throw bad_value(in_quotes(text) + " is not the name or the address of a machine or an interface");
}

}  // namespace

std::string_view name_of(discovery_range range) noexcept {
  return range_names[static_cast<std::size_t>(range)];
}

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

network read_network(std::optional<std::uint32_t> domain, const std::string& interface,
                     const environment& from) {
  network made{.interface = interface, .more = from("CYCLONEDDS_URI")};
  made.domain = domain ? *domain : domain_of(from("ROS_DOMAIN_ID"));
  const bool only_here = from("ROS_LOCALHOST_ONLY") == "1";
  made.range =
      only_here ? discovery_range::localhost : range_of(from("ROS_AUTOMATIC_DISCOVERY_RANGE"));
  if (only_here || made.range == discovery_range::off) return made;
  std::istringstream words(from("ROS_STATIC_PEERS"));
  for (std::string word; std::getline(words, word, ';');) {
    if (!word.empty()) made.peers.push_back(word);
  }
  return made;
}

std::string configuration(const network& wanted) {
  std::string general;
  std::string discovery;
  const bool is_local = wanted.range == discovery_range::localhost;
  std::string interface = wanted.interface;
  // Peers on other machines are not reachable by loopback alone.
  if (interface.empty() && is_local && wanted.peers.empty()) interface = "127.0.0.1";
  if (!interface.empty()) {
    const bool is_address = interface.find_first_of(".:") != std::string::npos;
    general += fmt::format(R"(<Interfaces><NetworkInterface {}="{}"/></Interfaces>)",
                           is_address ? "address" : "name", checked_name(interface));
  }
  if (is_local || wanted.range == discovery_range::off) {
    general += "<AllowMulticast>false</AllowMulticast>";
  }
  if (wanted.range == discovery_range::off) {
    discovery =
        fmt::format("<ParticipantIndex>none</ParticipantIndex><Tag>alone_{}</Tag>", ::getpid());
  } else if (wanted.range != discovery_range::system_default) {
    std::vector<std::string> peers = wanted.peers;
    if (is_local) peers.emplace_back("localhost");
    discovery = fmt::format(
        "<ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex>",
        peers.empty() ? most_participants : unicast_participants);
    if (!peers.empty()) {
      discovery += "<Peers>";
      for (const std::string& peer : peers) {
        discovery += fmt::format(R"(<Peer address="{}"/>)", checked_name(peer));
      }
      discovery += "</Peers>";
    }
  }
  std::string made = "<CycloneDDS><Domain>";
  if (!general.empty()) made += "<General>" + general + "</General>";
  if (!discovery.empty()) made += "<Discovery>" + discovery + "</Discovery>";
  // A message is not acknowledged if it follows the previous one within four fifths of this interval. A thread for each
  // socket would wait, at the end, for a packet to its own address, which may not exist any more.
  made +=
      "<Internal><HeartbeatInterval>10ms</HeartbeatInterval>"
      "<MultipleReceiveThreads>false</MultipleReceiveThreads></Internal>";
  return made + "</Domain></CycloneDDS>" + (wanted.more.empty() ? "" : "," + wanted.more);
}

std::vector<std::string> addresses(std::string_view interface) {
  ifaddrs* all = nullptr;
  if (::getifaddrs(&all) != 0) return {};
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owned(all, ::freeifaddrs);
  std::vector<std::string> found;
  std::vector<std::string> without_multicast;
  for (const ifaddrs* each = all; each != nullptr; each = each->ifa_next) {
    const bool is_up = (each->ifa_flags & (IFF_UP | IFF_RUNNING)) == (IFF_UP | IFF_RUNNING);
    if (!is_up || each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    if ((each->ifa_flags & IFF_LOOPBACK) != 0) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* const address = reinterpret_cast<const sockaddr_in*>(each->ifa_addr);
    if (::inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size()) == nullptr) continue;
    if (!interface.empty() && interface != each->ifa_name && interface != text.data()) continue;
    const bool has_multicast = (each->ifa_flags & IFF_MULTICAST) != 0;
    (has_multicast ? found : without_multicast)
        .push_back(std::string(each->ifa_name) + " " + text.data());
  }
  found.insert(found.end(), without_multicast.begin(), without_multicast.end());
  return found;
}

bool has_moved(const std::vector<std::string>& before, const std::vector<std::string>& now) {
  if (before.empty() || now.empty()) return before.empty() != now.empty();
  const auto is_there = [&now](const std::string& each) {
    return std::ranges::find(now, each) != now.end();
  };
  return before.front() != now.front() || !std::ranges::all_of(before, is_there);
}

}  // namespace g4_tool::dds
