// SPDX-License-Identifier: MIT
// The verbs dump and scan: points, or whole revolutions, of any source.
#pragma once

#include <cstddef>
#include <memory>

#include "common_options.hpp"
#include "pcd_writer.hpp"
#include "point_style.hpp"
#include "source.hpp"

namespace g4_dump {

struct dump_options {
  shared_options common = std::make_shared<common_options>();
  point_style style{.format = text_format::text, .as_they_come = true};
  bool partial = false;  ///< Pieces of revolutions, too.
  std::size_t bins = 0;  ///< 0: points and no grid.
  bool pcd = false;
  pcd_data data = pcd_data::binary;
  opening source{};  ///< How it is opened.
};

/// Returns the exit code; throws a failure or a bad_value.
[[nodiscard]] int run(const dump_options& options);

}  // namespace g4_dump
