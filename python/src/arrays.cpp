// SPDX-License-Identifier: MIT
#include "arrays.hpp"

#include <array>
#include <cstdint>
#include <string>

namespace g4lidar::python {
namespace {

/// The functions and dtypes of NumPy that are used; they live as long as the program.
struct numpy_parts {
  nb::object contiguous;
  nb::object empty;
  std::array<nb::object, 4> dtypes;
};
numpy_parts* numpy = nullptr;

struct field {
  const char* name;
  const char* format;
  std::size_t offset;
};

nb::object make_dtype(const nb::module_& module, std::initializer_list<field> fields,
                      std::size_t size) {
  nb::list names;
  nb::list formats;
  nb::list offsets;
  for (const field& each : fields) {
    names.append(each.name);
    formats.append(each.format);
    offsets.append(each.offset);
  }
  nb::dict how;
  how["names"] = names;
  how["formats"] = formats;
  how["offsets"] = offsets;
  how["itemsize"] = size;
  return module.attr("dtype")(how);
}

}  // namespace

buffer::buffer(nb::handle object, bool writable) {
  const int flags = writable ? PyBUF_WRITABLE : PyBUF_SIMPLE;
  if (in_python([&] { return PyObject_GetBuffer(object.ptr(), &view_, flags); }) != 0)
    throw nb::python_error();
}

nb::handle dtype_of(element what) { return numpy->dtypes[static_cast<std::size_t>(what)]; }

nb::object contiguous(nb::handle given, element type) {
  return in_python([&]() -> nb::object {
    const nb::handle wanted = dtype_of(type);
    const nb::object found = given.attr("dtype");
    if (!found.is(wanted) && !found.equal(wanted)) {
      const std::string text = "an array with the dtype " + std::string(nb::str(wanted).c_str()) +
                               " is needed, not " + nb::str(found).c_str();
      throw nb::type_error(text.c_str());
    }
    nb::object made = numpy->contiguous(given);
    const auto address = reinterpret_cast<std::uintptr_t>(buffer(made).read().data());
    const std::size_t alignment = type == element::single ? alignof(float) : alignof(point);
    return address % alignment == 0 ? made : made.attr("copy")();
  });
}

nb::object new_array(element type, std::size_t count, std::size_t columns) {
  if (columns > 0) return numpy->empty(nb::make_tuple(count, columns), dtype_of(type));
  return numpy->empty(count, dtype_of(type));
}

void bind_arrays(nb::module_& module) {
  const nb::module_ from = nb::module_::import_("numpy");
  numpy = new numpy_parts{
      from.attr("ascontiguousarray"),
      from.attr("empty"),
      {make_dtype(from,
                  {{"angle_deg", "<f4", offsetof(point, angle_deg)},
                   {"range_mm", "<f4", offsetof(point, range_mm)},
                   {"time_ns", "<i8", offsetof(point, time_ns)},
                   {"revolution", "<u4", offsetof(point, revolution)},
                   {"flags", "u1", offsetof(point, flags)},
                   {"sample_flags", "u1", offsetof(point, sample_flags)},
                   {"intensity", "<u2", offsetof(point, intensity)}},
                  sizeof(point)),
       make_dtype(from,
                  {{"time_ns", "<i8", offsetof(stamped_pose, time_ns)},
                   {"x_m", "<f8", offsetof(stamped_pose, pose) + offsetof(pose_2d, x_m)},
                   {"y_m", "<f8", offsetof(stamped_pose, pose) + offsetof(pose_2d, y_m)},
                   {"yaw_rad", "<f8", offsetof(stamped_pose, pose) + offsetof(pose_2d, yaw_rad)}},
                  sizeof(stamped_pose)),
       make_dtype(from,
                  {{"time_ns", "<i8", offsetof(true_sample, time_ns)},
                   {"bearing_deg", "<f8", offsetof(true_sample, bearing_deg)},
                   {"range_mm", "<f8", offsetof(true_sample, range_mm)}},
                  sizeof(true_sample)),
       from.attr("dtype")("<f4")}};
  module.attr("POINT_DTYPE") = dtype_of(element::point);
  module.attr("POSE_DTYPE") = dtype_of(element::pose);
}

}  // namespace g4lidar::python
