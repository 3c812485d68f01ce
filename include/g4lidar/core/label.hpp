// SPDX-License-Identifier: MIT
// The names by which people call lidars: the words of the table in any spelling, and products that are not supported.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "g4lidar/detail/api.hpp"

namespace g4lidar {

namespace detail {

/// Takes the next character that counts from `rest`, in lower case; -1 at the end. *Pure.*
[[nodiscard]] constexpr int next_of_label(std::string_view& rest) noexcept {
  while (!rest.empty()) {
    const char next = rest.front();
    rest.remove_prefix(1);
    if (next == ' ' || next == '-' || next == '_') continue;
    return next >= 'A' && next <= 'Z' ? next - 'A' + 'a' : next;
  }
  return -1;
}

/// `label` without the name of the maker before it. *Pure.*
[[nodiscard]] constexpr std::string_view without_maker(std::string_view label) noexcept {
  std::string_view rest = label;
  constexpr std::string_view maker = "ydlidar";
  for (const char letter : maker) {
    if (next_of_label(rest) != letter) return label;
  }
  return rest;
}

struct other_label {
  std::string_view label;
  std::string_view word;
};
inline constexpr std::array<other_label, 4> other_labels{
    {{"G2B", "g2"},
     {"X2N", "x2"},
     {"S2 with intensity", "s2-intensity"},
     {"S2 Pro with intensity", "s2-pro-intensity"}}};

/// A product of the manufacturer with another protocol, and the numbers that identify it.
struct other_product {
  std::uint8_t first;
  std::uint8_t last;
  std::string_view name;
};
inline constexpr std::array<other_product, 12> other_products{{{23, 23, "R3"},
                                                               {51, 51, "GS1"},
                                                               {52, 52, "GS2"},
                                                               {53, 53, "GS5"},
                                                               {54, 54, "GS6"},
                                                               {110, 110, "TEA"},
                                                               {130, 130, "TSA"},
                                                               {131, 131, "TSA Pro"},
                                                               {160, 160, "SDM15"},
                                                               {161, 161, "SDM18"},
                                                               {200, 200, "T15 or T30"},
                                                               {210, 212, "TIA"}}};

inline constexpr std::string_view other_protocol = "it has another protocol";
inline constexpr std::string_view line_sensor = "it has another protocol, usual driver YDLidar-SDK";
inline constexpr std::string_view depth_camera = "a depth camera";
inline constexpr std::string_view of_ldrobot = "a lidar of LDROBOT, usual driver ldlidar_stl_ros2";
inline constexpr std::string_view of_slamtec = "a lidar of Slamtec, usual driver sllidar_ros2";
inline constexpr std::string_view of_another_maker = "a lidar of another maker";
inline constexpr std::string_view coin_d4 = "read it as t-mini-pro with --listen (listen_only)";

/// A name on the label of a device that cannot be read, and why.
struct unsupported_label {
  std::string_view label;
  std::string_view why;
  bool is_begin = false;  // of the names of several: "LD19P" begins with "LD19"
};
inline constexpr auto unsupported_labels = std::to_array<unsupported_label>({
    {"R3", other_protocol},
    {"TEA", other_protocol, true},
    {"TSA", other_protocol, true},
    {"TIA", other_protocol, true},
    {"T15", other_protocol},
    {"T30", other_protocol},
    {"GS1", line_sensor},
    {"GS2", line_sensor, true},
    {"GS5", line_sensor},
    {"GS6", line_sensor},
    {"SDM", line_sensor, true},
    {"OS30", depth_camera, true},
    {"HP60", depth_camera, true},
    {"COIN-D4", coin_d4, true},
    {"LDS-03", coin_d4},
    {"LDROBOT", of_ldrobot, true},
    {"LDLIDAR", of_ldrobot, true},
    {"LD06", of_ldrobot, true},
    {"LD14", of_ldrobot, true},
    {"LD19", of_ldrobot, true},
    {"STL", of_ldrobot, true},
    {"RPLIDAR", of_slamtec, true},
    {"SLLIDAR", of_slamtec, true},
    {"Slamtec", of_slamtec, true},
    {"A1", of_slamtec},
    {"A1M", of_slamtec, true},
    {"A2", of_slamtec},
    {"A2M", of_slamtec, true},
    {"A3", of_slamtec},
    {"A3M", of_slamtec, true},
    {"C1", of_slamtec},
    {"C1M", of_slamtec, true},
    {"XV-11", "a lidar of Neato, usual driver xv_11_driver", true},
    {"Neato", "a lidar of Neato, usual driver xv_11_driver", true},
    {"LDS-01", "a lidar of Hitachi-LG, usual driver hls_lfcd_lds_driver"},
    {"HLS-LFCD", "a lidar of Hitachi-LG, usual driver hls_lfcd_lds_driver", true},
    {"3irobotix", "a lidar of 3irobotix, usual driver delta_lidar", true},
    {"Delta", "a lidar of 3irobotix, usual driver delta_lidar", true},
    {"Camsense", "a lidar of Camsense, usual driver camsense_driver", true},
    {"LDS-02", of_another_maker},
    {"LD08", of_another_maker},
    {"MS200", of_another_maker, true},
    {"Hokuyo", of_another_maker, true},
    {"URG", of_another_maker, true},
    {"UST", of_another_maker, true},
    {"UTM", of_another_maker, true},
    {"SICK", of_another_maker, true},
    {"TiM", of_another_maker, true},
    {"TF", of_another_maker, true},
    {"LSLIDAR", of_another_maker, true},
    {"N10", of_another_maker},
    {"M10", of_another_maker},
    {"VLP", of_another_maker, true},
    {"Velodyne", of_another_maker, true},
    {"Livox", of_another_maker, true},
    {"Hesai", of_another_maker, true},
    {"Ouster", of_another_maker, true},
});

/// Whether `label` is the same name as `begin`, or, with `has_more`, begins with it. *Pure.*
[[nodiscard]] constexpr bool is_named(std::string_view label, std::string_view begin,
                                      bool has_more) noexcept {
  while (true) {
    const int wanted = next_of_label(begin);
    if (wanted < 0) return has_more || next_of_label(label) < 0;
    if (next_of_label(label) != wanted) return false;
  }
}

}  // namespace detail

/// Whether both are the same name: "T-mini Pro", "tminipro", "YDLIDAR T_MINI_PRO". Case, blanks, hyphens, underscores
/// and the name of the maker do not count. *Pure.*
[[nodiscard]] constexpr bool is_same_label(std::string_view a, std::string_view b) noexcept {
  return detail::is_named(detail::without_maker(a), detail::without_maker(b), false);
}

/// Whether `label` names the model with this word in any spelling, or by another label that its devices have: "X2N" is
/// an "x2". *Pure.*
[[nodiscard]] constexpr bool is_label_of(std::string_view label, std::string_view word) noexcept {
  for (const detail::other_label& each : detail::other_labels) {
    if (each.word == word && is_same_label(label, each.label)) return true;
  }
  return is_same_label(label, word);
}

/// Another product of the same manufacturer, which identifies itself with `id` and has another protocol; empty if none
/// is known. Valid forever. *Pure.*
[[nodiscard]] constexpr std::string_view other_product(std::uint8_t id) noexcept {
  for (const detail::other_product& each : detail::other_products) {
    if (id != 0 && each.first <= id && id <= each.last) return each.name;
  }
  return {};
}

/// Why a product with this label, in any spelling, is not supported: another one of the manufacturer, or a lidar of
/// another maker, with its usual driver. "a lidar of LDROBOT, ..."; empty if none is known. Valid forever. *Pure.*
[[nodiscard]] constexpr std::string_view why_unsupported(std::string_view label) noexcept {
  label = detail::without_maker(label);
  for (const detail::unsupported_label& each : detail::unsupported_labels) {
    if (detail::is_named(label, each.label, each.is_begin)) return each.why;
  }
  return {};
}

}  // namespace g4lidar
