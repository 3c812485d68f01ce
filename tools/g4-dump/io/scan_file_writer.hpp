// SPDX-License-Identifier: MIT
// Revolutions as files of their own: pcd or svg.
#pragma once

#include <cstdint>
#include <utility>

#include "export/svg.hpp"
#include "io/output.hpp"
#include "io/shape_files.hpp"
#include "output_form.hpp"

namespace g4_tool {

/// Each revolution goes to the output, or to a file of its own.
class scan_file_writer final : public point_writer {
 public:
  scan_file_writer(scan_file format, frame frame, pcd_data data, numbered_files files)
      : format_(format), frame_(frame), data_(data), files_(std::move(files)) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void write_scan(const scan_record& record, text_sink& out) override {
    if (!files_) return write(record.scan, out);
    output file(files_(number_++));
    write(record.scan, file);
    file.commit();
  }

 private:
  void write(const scan& revolution, text_sink& out) const {
    if (format_ == scan_file::svg) return write_svg(revolution, out);
    write_pcd(revolution, frame_, data_, out);
  }

  scan_file format_;
  frame frame_;
  pcd_data data_;
  numbered_files files_;
  std::uint64_t number_ = 0;
};

}  // namespace g4_tool
