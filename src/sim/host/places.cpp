// SPDX-License-Identifier: MIT
// The places where programs find a served device.
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "g4lidar/sim/setup.hpp"
#include "name_claim.hpp"

namespace g4lidar::sim {

namespace fs = std::filesystem;

std::string registered_link(std::string_view serial) {
  const std::string directory = registry();
  if (directory.empty()) return {};
  std::error_code unimportant;  // opening the link fails then
  fs::create_directories(directory, unimportant);
  return directory + "/g4-" + std::string(serial);
}

result<std::shared_ptr<background_pty>> serve_alone(device simulated) {
  std::error_code none;
  std::string directory = (fs::temp_directory_path(none) / "g4-sim-XXXXXX").native();
  if (none || ::mkdtemp(directory.data()) == nullptr) {
    return failure(task::opening, problem::system, directory, none ? none.value() : errno);
  }
  result<background_pty> port = background_pty::open(std::move(simulated), directory + "/lidar");
  if (!port) {
    fs::remove(directory, none);
    return tl::unexpected<error>(port.error());
  }
  return std::shared_ptr<background_pty>(new background_pty(std::move(*port)),
                                         [directory](const background_pty* served) {
                                           delete served;
                                           std::error_code unimportant;
                                           fs::remove_all(directory, unimportant);
                                         });
}

}  // namespace g4lidar::sim
