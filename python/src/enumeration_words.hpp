// SPDX-License-Identifier: MIT
// Enumerations as words: a frame of reference is 'robot' or 'vendor' in Python.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/string_view.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

#include "g4lidar/filter/outliers.hpp"
#include "g4lidar/grid.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/scan_shaper.hpp"
#include "g4lidar/settings.hpp"
#include "gil.hpp"

namespace g4lidar::python {

/// Sets `into` to the enumerator whose word `value` is; false if it is another object.
template <class Enumeration>
bool read_word(nanobind::handle value, std::initializer_list<std::string_view> words,
               Enumeration& into) noexcept {
  nanobind::detail::make_caster<std::string_view> text;
  if (!text.from_python(value, 0, nullptr)) return false;
  std::size_t index = 0;
  for (const std::string_view word : words) {
    if (word == text.value) {
      into = static_cast<Enumeration>(index);
      return true;
    }
    ++index;
  }
  return false;
}

/// The name of a file or a device: a str, or an object with __fspath__.
struct path_text {
  std::string text;
};

}  // namespace g4lidar::python

template <>
struct nanobind::detail::type_caster<g4lidar::python::path_text> {
  NB_TYPE_CASTER(g4lidar::python::path_text, const_name("str | os.PathLike[str]"))
  bool from_python(handle given, std::uint32_t flags, cleanup_list* list) noexcept {
    const object path = steal(g4lidar::python::in_python([&] { return PyOS_FSPath(given.ptr()); }));
    make_caster<std::string_view> text;
    if (!path.is_valid() || !text.from_python(path, flags, list)) {
      PyErr_Clear();
      return false;
    }
    value.text = text.value;
    return true;
  }
  static handle from_cpp(const g4lidar::python::path_text& from, rv_policy,
                         cleanup_list*) noexcept {
    return PyUnicode_FromStringAndSize(from.text.data(), static_cast<Py_ssize_t>(from.text.size()));
  }
};

/// The words of an enumeration with the values 0, 1 and 2.
#define G4LIDAR_THREE_WORDS(Enumeration, first_word, second_word, third_word)                 \
  template <>                                                                                 \
  struct nanobind::detail::type_caster<Enumeration> {                                         \
    NB_TYPE_CASTER(Enumeration, const_name("typing.Literal['" first_word "', '" second_word   \
                                           "', '" third_word "']"))                           \
    bool from_python(handle given, std::uint32_t, cleanup_list*) noexcept {                   \
      return g4lidar::python::read_word(given, {first_word, second_word, third_word}, value); \
    }                                                                                         \
    static handle from_cpp(Enumeration value, rv_policy, cleanup_list*) noexcept {            \
      constexpr std::array<const char*, 3> words{first_word, second_word, third_word};        \
      return PyUnicode_FromString(words[static_cast<std::size_t>(value)]);                    \
    }                                                                                         \
  }

/// The words of an enumeration with the values 0 and 1.
#define G4LIDAR_WORDS(Enumeration, first_word, second_word)                                        \
  template <>                                                                                      \
  struct nanobind::detail::type_caster<Enumeration> {                                              \
    NB_TYPE_CASTER(Enumeration, const_name("typing.Literal['" first_word "', '" second_word "']")) \
    bool from_python(handle given, std::uint32_t, cleanup_list*) noexcept {                        \
      return g4lidar::python::read_word(given, {first_word, second_word}, value);                  \
    }                                                                                              \
    static handle from_cpp(Enumeration value, rv_policy, cleanup_list*) noexcept {                 \
      return PyUnicode_FromString(static_cast<int>(value) == 0 ? first_word : second_word);        \
    }                                                                                              \
  }

G4LIDAR_WORDS(g4lidar::frame, "vendor", "robot");
G4LIDAR_WORDS(g4lidar::grid_pick, "nearest", "minimum");
G4LIDAR_WORDS(g4lidar::scan_ends, "joined", "open");
G4LIDAR_WORDS(g4lidar::motor_direction, "clockwise", "counter_clockwise");
G4LIDAR_WORDS(g4lidar::packing, "none", "zstd");
G4LIDAR_WORDS(g4lidar::scan_order, "angle", "time");
G4LIDAR_THREE_WORDS(g4lidar::no_return_as, "inf", "nan", "max");
G4LIDAR_THREE_WORDS(g4lidar::deskewing, "none", "by_path", "by_scans");
