// SPDX-License-Identifier: MIT
// make_diagnostics <directory>: the schema of a DiagnosticArray, and a message of a lidar in use, in files.
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "support/virtual_transport.hpp"

namespace {

using namespace g4lidar;
using namespace std::chrono_literals;

void write(const std::string& path, const void* data, std::size_t size) {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  std::fwrite(data, 1, size, file);
  std::fclose(file);
}

int run(const std::string& directory) {
  const message_schema schema = diagnostic_array_schema();
  write(directory + "/schema.txt", schema.text.data(), schema.text.size());
  const sim::fault flip = sim::make_fault(sim::fault_kind::flip);
  test::virtual_bench bench({}, std::span(&flip, 1));
  running_diagnosis judge;
  auto device = lidar::open(judge.observe(std::make_unique<test::virtual_connector>(bench)));
  if (!device || !device->start()) return 1;
  while (bench.now_ns < 12'000'000'000) static_cast<void>(device->try_scan(500ms));
  const auto statuses = statuses_of(judge.stages(), device->counts(), "2021101000070073");
  std::vector<std::uint8_t> message;
  put_diagnostic_array(statuses, 1'700'000'000'123'456'789, message);
  write(directory + "/message.cdr", message.data(), message.size());
  for (const diagnostic_status& each : statuses) {
    std::printf("status\t%d\t%s\t%s\t%s\n", static_cast<int>(each.level), each.name.c_str(),
                each.message.c_str(), each.hardware_id.c_str());
    for (const auto& [name, value] : each.values) {
      std::printf("value\t%s\t%s\n", name.c_str(), value.c_str());
    }
  }
  return 0;
}

}  // namespace

int main(int count, char** words) { return count == 2 ? run(words[1]) : 2; }
