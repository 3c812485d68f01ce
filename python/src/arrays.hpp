// SPDX-License-Identifier: MIT
// NumPy arrays of points, poses and numbers, in both directions. NumPy owns the memory of every array that is
// returned, so an array is valid as long as Python keeps it.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <span>
#include <type_traits>
#include <utility>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/bytes.hpp"
#include "g4lidar/motion.hpp"
#include "g4lidar/point.hpp"
#include "gil.hpp"

namespace g4lidar::python {

namespace nb = nanobind;

/// The memory of an object with the buffer protocol; valid as long as this. Needs the GIL.
class buffer {
 public:
  /// Raises what the object raises: BufferError, if it is not contiguous or may not be written.
  explicit buffer(nb::handle object, bool writable = false);
  buffer(const buffer&) = delete;
  buffer& operator=(const buffer&) = delete;
  ~buffer() { PyBuffer_Release(&view_); }

  [[nodiscard]] bytes read() const noexcept {
    return {static_cast<const std::uint8_t*>(view_.buf), static_cast<std::size_t>(view_.len)};
  }
  /// As elements of this type.
  template <class Element>
  [[nodiscard]] std::span<Element> as() const noexcept {
    return {static_cast<Element*>(view_.buf),
            static_cast<std::size_t>(view_.len) / sizeof(Element)};
  }

 private:
  Py_buffer view_{};
};

/// A sample of a simulated lidar with its true values, as Python gets it.
struct true_sample {
  std::int64_t time_ns;
  double bearing_deg;
  double range_mm;
};

/// The element types of the arrays.
enum class element { point, pose, truth, single };
template <class Element>
inline constexpr element element_of = element::single;
template <>
inline constexpr element element_of<point> = element::point;
template <>
inline constexpr element element_of<stamped_pose> = element::pose;
template <>
inline constexpr element element_of<true_sample> = element::truth;

/// A NumPy array with this element, as an argument or a result.
template <class Element>
struct array {
  nb::object object;
};

/// The dtype. Made by bind_arrays().
[[nodiscard]] nb::handle dtype_of(element what);
/// `given`, or a copy, as a contiguous array with aligned elements; raises TypeError if its elements are others.
[[nodiscard]] nb::object contiguous(nb::handle given, element type);
/// A new array with room for `count` elements, or rows of `columns`.
[[nodiscard]] nb::object new_array(element type, std::size_t count, std::size_t columns = 0);

/// The elements of an argument; valid as long as this.
template <class Element>
class elements {
 public:
  explicit elements(const array<Element>& given)
      : array_(contiguous(given.object, element_of<Element>)), memory_(array_) {}
  [[nodiscard]] std::span<const Element> span() const noexcept {
    return memory_.template as<const Element>();
  }

 private:
  nb::object array_;
  buffer memory_;
};

/// A new array that `fill(span)` writes; if it returns a number, only so many elements are kept.
template <class Element, class Fill>
[[nodiscard]] array<Element> make_array(std::size_t count, const Fill& fill) {
  nb::object made = new_array(element_of<Element>, count);
  std::size_t kept = count;
  {
    const buffer memory(made, true);
    if constexpr (std::is_void_v<decltype(fill(memory.as<Element>()))>) {
      fill(memory.as<Element>());
    } else {
      kept = fill(memory.as<Element>());
    }
  }
  if (kept < count) made = made[nb::slice(nb::int_(0), nb::int_(kept), nb::int_(1))];
  return {std::move(made)};
}

/// A copy of these elements.
template <class Element>
[[nodiscard]] array<Element> array_of(std::span<const Element> from) {
  return make_array<Element>(from.size(), [from](std::span<Element> to) {
    if (!from.empty()) std::memcpy(to.data(), from.data(), from.size_bytes());
  });
}

/// Defines POINT_DTYPE and the others.
void bind_arrays(nb::module_& module);

}  // namespace g4lidar::python

namespace nanobind::detail {

template <class Element>
struct type_caster<g4lidar::python::array<Element>> {
  NB_TYPE_CASTER(
      g4lidar::python::array<Element>,
      const_name<g4lidar::python::element_of<Element> == g4lidar::python::element::single>(
          const_name("numpy.typing.NDArray[numpy.float32]"),
          const_name("numpy.typing.NDArray[numpy.void]")))

  bool from_python(handle given, std::uint8_t, cleanup_list*) noexcept {
    if (!g4lidar::python::in_python([&] { return hasattr(given, "dtype"); })) return false;
    value.object = borrow(given);
    return true;
  }
  static handle from_cpp(const g4lidar::python::array<Element>& from, rv_policy,
                         cleanup_list*) noexcept {
    return handle(from.object).inc_ref();
  }
};

}  // namespace nanobind::detail
