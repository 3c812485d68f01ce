// SPDX-License-Identifier: MIT
// The lines that this computer has to a device: serial ports, network bridges, files.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/connector.hpp"

namespace g4lidar {

/// What lidar_options::device names, opened again and again. A device that was named by a path or by
/// itself is looked for behind all bridges once it has been lost: the driver knows it when it sees it.
class system_connector final : public connector {
 public:
  /// Fails with bad_option where `device` cannot be understood.
  [[nodiscard]] static result<std::unique_ptr<connector>> make(std::string_view device,
                                                               std::uint32_t baud);
  ~system_connector() override;

  [[nodiscard]] result<std::unique_ptr<transport>> connect() noexcept override;
  [[nodiscard]] std::int64_t now_ns() const noexcept override;
  [[nodiscard]] bool pause(std::int64_t deadline_ns) noexcept override;
  void wake() noexcept override;

 private:
  system_connector(std::string_view device, std::uint32_t baud);

  [[nodiscard]] result<std::unique_ptr<transport>> open_line();
  [[nodiscard]] result<std::unique_ptr<transport>> first_connect();
  [[nodiscard]] result<std::unique_ptr<transport>> connect_again();

  std::string device_;
  std::uint32_t baud_;
  std::string path_;                // where it was first
  std::vector<std::string> paths_;  // to be tried in this round
  int wake_;
};

}  // namespace g4lidar
