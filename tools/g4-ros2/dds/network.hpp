// SPDX-License-Identifier: MIT
// Which network a ROS 2 domain is on: from the options, and from the variables that ROS 2 reads.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace g4_tool::dds {

/// Who can discover this program, as ROS_AUTOMATIC_DISCOVERY_RANGE names it.
enum class discovery_range : unsigned char { subnet, localhost, off, system_default };

/// "LOCALHOST"
[[nodiscard]] std::string_view name_of(discovery_range range) noexcept;

struct network {
  std::uint32_t domain = 0;
  discovery_range range = discovery_range::subnet;
  std::vector<std::string>
      peers{};              ///< Machines to which this program is announced, by name or address.
  std::string interface{};  ///< A name or an address; empty: any.
  std::string more{};       ///< The contents of CYCLONEDDS_URI, which has the last word.
};

/// The value of a variable; empty where it is not set.
using environment = std::function<std::string(const char*)>;
/// That of this process.
[[nodiscard]] std::string variable(const char* name);

/// The domain and the interface of the command line, and the rest from the variables. What is wrong
/// with a variable is reported, and what ROS 2 then does is done. Throws bad_value for a domain that
/// is none.
[[nodiscard]] network read_network(std::optional<std::uint32_t> domain,
                                   const std::string& interface,
                                   const environment& from = variable);

/// The configuration of Cyclone DDS for it. Throws bad_value for an interface or a peer that cannot
/// be one.
[[nodiscard]] std::string configuration(const network& wanted);

/// The addresses of the interfaces that are up, and not loopback, as "eth0 192.0.2.2", the one that Cyclone DDS takes
/// first; of `interface` only, if it is not empty.
[[nodiscard]] std::vector<std::string> addresses(std::string_view interface = {});

/// Whether a domain that was created on `before` must be created again: an address is gone, or another one is
/// first now.
[[nodiscard]] bool has_moved(const std::vector<std::string>& before,
                             const std::vector<std::string>& now);

}  // namespace g4_tool::dds
