// SPDX-License-Identifier: MIT
// The network of a ROS 2 domain, from the options and from the environment variables of ROS 2.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace g4_tool::dds {

/// The programs that can discover this one: the values of ROS_AUTOMATIC_DISCOVERY_RANGE.
enum class discovery_range : unsigned char { subnet, localhost, off, system_default };

/// "LOCALHOST"
[[nodiscard]] std::string_view name_of(discovery_range range) noexcept;

struct network {
  std::uint32_t domain = 0;
  discovery_range range = discovery_range::subnet;
  std::vector<std::string> peers{};  ///< Names or addresses of machines that are informed.
  std::string interface{};           ///< A name or an address; empty: any.
  std::string more{};                ///< The contents of CYCLONEDDS_URI, which overrides the rest.
};

/// Returns the value of a variable; empty if it is not set.
using environment = std::function<std::string(const char*)>;
/// A variable of this process.
[[nodiscard]] std::string variable(const char* name);

/// The domain and the interface from the command line, all else from the variables. An invalid variable
/// is logged and has the effect that it has in ROS 2. Throws bad_value for an invalid domain.
[[nodiscard]] network read_network(std::optional<std::uint32_t> domain,
                                   const std::string& interface,
                                   const environment& variables = variable);

/// Whether CYCLONEDDS_URI names network interfaces itself, which then are the only ones.
[[nodiscard]] bool names_interfaces(const std::string& uri);

/// Whether it is on loopback and the first network: with LOCALHOST, unless the user names an interface.
[[nodiscard]] bool is_on_loopback(const network& wanted);
/// The multicast packets of all sockets of this process go to loopback. Cyclone DDS would send those to a peer with a
/// multicast address to each interface. (With a TTL of 0 they leave the machine where nobody there has joined the group.)
void keep_multicast_here() noexcept;

/// The configuration for Cyclone DDS. `is_connected`: there is an interface that is not loopback. Throws bad_value for an
/// invalid interface or peer.
[[nodiscard]] std::string configuration(const network& wanted, bool is_connected);

/// The addresses of the interfaces that are up, without loopback, as "eth0 192.0.2.2". The one that Cyclone DDS uses is
/// the first. Only those of `interface`, if it is not empty.
[[nodiscard]] std::vector<std::string> addresses(std::string_view interface = {});

/// Whether a domain that was created on `before` must be created again: an address was removed, or the first one has
/// changed.
[[nodiscard]] bool has_moved(const std::vector<std::string>& before,
                             const std::vector<std::string>& now);

}  // namespace g4_tool::dds
