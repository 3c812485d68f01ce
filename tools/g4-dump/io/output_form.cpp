// SPDX-License-Identifier: MIT
#include "output_form.hpp"

#include "export/slam_text.hpp"
#include "scan_file_writer.hpp"

namespace g4_tool {

chosen_writer make_writer(const output_form& form, const common_options& common, const model& model,
                          const numbered_files& files) {
  if (form.point_file) {
    auto made = make_point_file_writer(*form.point_file, common.frame, model);
    auto* const point_file = made.get();
    return {std::move(made), point_file};
  }
  if (form.has_scan_files())
    return {std::make_unique<scan_file_writer>(form.file, common.frame, form.data, files)};
  const std::size_t bins = form.bins_of(model);
  if (form.log == slam_log::carmen)
    return {make_carmen_writer(bins, common.mount.value_or(mounting{}))};
  if (form.log == slam_log::tum) return {make_tum_writer()};
  text_style style = form.style;
  style.to = common.frame;
  style.unit = common.unit;
  style.intensity = has_intensity(model);
  style.sample_flags = has_sample_flags(model.samples.layout);
  style.turn_deg = model.turn_deg;
  if (bins > 0) return {make_grid_writer(style, bins, common.grid)};
  return {make_point_writer(style)};
}

}  // namespace g4_tool
