// SPDX-License-Identifier: MIT
#include "network.hpp"

#include <arpa/inet.h>
#include <dds/ddsrt/xmlparser.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <strings.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>

#include "cli/logger.hpp"
#include "cli/option_rows.hpp"

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

/// Sets `found` (a bool) at an element that selects interfaces. The names of elements have no case.
int see_element(void* found, std::uintptr_t, std::uintptr_t*, const char* name, int) {
  for (const char* const each : {"Interfaces", "NetworkInterfaceAddress"}) {
    if (::strcasecmp(name, each) == 0) *static_cast<bool*>(found) = true;
  }
  return 0;
}

constexpr ddsrt_xmlp_callbacks element_callbacks{
    .elem_open = see_element,
    .attr = [](void*, std::uintptr_t, const char*, const char*, int) { return 0; },
    .elem_data = [](void*, std::uintptr_t, const char*, int) { return 0; },
    .elem_close = [](void*, std::uintptr_t, int) { return 0; },
    .error = [](void*, const char*, int) {}};  // Cyclone DDS reports it

/// Parses and releases `of`; the characters that were read. Stops at the end of the first element.
std::size_t parse(ddsrt_xmlp_state* parser) {
  ddsrt_xmlp_set_options(parser, 0);
  static_cast<void>(ddsrt_xmlp_parse(parser));
  const std::size_t read = ddsrt_xmlp_get_bufpos(parser);
  ddsrt_xmlp_free(parser);
  return read;
}

/// The line of interfaces: that of the user, or those on which the programs of this machine meet. With LOCALHOST some
/// middlewares of ROS 2 use loopback, and some the first network.
std::string interfaces_of(const network& wanted, bool is_connected) {
  std::string made;
  if (!wanted.interface.empty()) {
    const bool is_address = wanted.interface.find_first_of(".:") != std::string::npos;
    made = fmt::format(R"(<NetworkInterface {}="{}"/>)", is_address ? "address" : "name",
                       checked_name(wanted.interface));
  } else if (is_on_loopback(wanted)) {
    made = R"(<NetworkInterface address="127.0.0.1"/>)";
    if (is_connected) made += R"(<NetworkInterface autodetermine="true"/>)";
  }
  if (made.empty() || names_interfaces(wanted.more)) return "";
  return "<Interfaces>" + made + "</Interfaces>";
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
                     const environment& variables) {
  network made{.interface = interface, .more = variables("CYCLONEDDS_URI")};
  made.domain = domain ? *domain : domain_of(variables("ROS_DOMAIN_ID"));
  const bool only_here = variables("ROS_LOCALHOST_ONLY") == "1";
  made.range =
      only_here ? discovery_range::localhost : range_of(variables("ROS_AUTOMATIC_DISCOVERY_RANGE"));
  if (only_here || made.range == discovery_range::off) return made;
  std::istringstream words(variables("ROS_STATIC_PEERS"));
  for (std::string word; std::getline(words, word, ';');) {
    if (!word.empty()) made.peers.push_back(word);
  }
  return made;
}

bool names_interfaces(const std::string& uri) {
  bool found = false;
  for (std::size_t at = 0; at < uri.size();) {
    if (uri[at] == '<') {
      at += std::max<std::size_t>(
          parse(ddsrt_xmlp_new_string(uri.c_str() + at, &found, &element_callbacks)), 1);
    } else if (uri[at] == ',' || uri[at] == ' ') {
      ++at;
    } else {
      const std::size_t end = std::min(uri.find(',', at), uri.size());
      constexpr std::string_view scheme = "file://";
      if (uri.compare(at, scheme.size(), scheme) == 0) at += scheme.size();
      const std::string path = uri.substr(at, end - at);
      if (std::FILE* const file = std::fopen(path.c_str(), "r"); file != nullptr) {
        static_cast<void>(parse(ddsrt_xmlp_new_file(file, &found, &element_callbacks)));
        static_cast<void>(std::fclose(file));
      }
      at = end;
    }
  }
  return found;
}

bool is_on_loopback(const network& wanted) {
  return wanted.range == discovery_range::localhost && wanted.interface.empty() &&
         !names_interfaces(wanted.more);
}

std::string configuration(const network& wanted, bool is_connected) {
  std::string general = interfaces_of(wanted, is_connected);
  std::string discovery;
  const bool is_local = wanted.range == discovery_range::localhost;
  if (is_local || wanted.range == discovery_range::off) {
    general += "<AllowMulticast>false</AllowMulticast>";
  }
  if (wanted.range == discovery_range::off) {
    discovery =
        fmt::format("<ParticipantIndex>none</ParticipantIndex><Tag>alone_{}</Tag>", ::getpid());
  } else if (wanted.range != discovery_range::system_default) {
    std::vector<std::string> peers = wanted.peers;
    if (is_local) peers.emplace_back("localhost");
    // Where loopback has multicast, Humble with Cyclone DDS listens to nothing else. See keep_multicast_here().
    if (is_on_loopback(wanted)) peers.emplace_back("239.255.0.1");
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
  // ROS 2 Humble with Fast DDS finds this program by its announcements only, and waits for the next one.
  if (is_local) discovery += "<SPDPInterval>1s</SPDPInterval>";
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

void keep_multicast_here() noexcept {
  constexpr int all = 65536;
  const in_addr loopback{htonl(INADDR_LOOPBACK)};
  for (int fd = 0; fd < all; ++fd) {  // of what is no such socket it fails
    static_cast<void>(::setsockopt(fd, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback));
  }
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
