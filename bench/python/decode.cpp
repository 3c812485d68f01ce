// SPDX-License-Identifier: MIT
// decode_bench FILE REPETITIONS: bulk decoding of a file in C++, for the comparison of bench/python.sh. Prints points per
// second of processor time, with memory that is used again, and with new memory for each decoding.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <g4lidar/recording/bulk_decoder.hpp>
#include <iterator>
#include <memory>
#include <span>
#include <vector>

namespace {

double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::size_t decode(const std::vector<std::uint8_t>& data, std::span<g4lidar::point> out) {
  g4lidar::bulk_decoder decoder;
  g4lidar::bytes input = data;
  return decoder.decode(input, out).size();
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) return 2;
  std::ifstream file(words[1], std::ios::binary);
  const std::vector<std::uint8_t> data(std::istreambuf_iterator<char>(file), {});
  const int repetitions = std::atoi(words[2]);
  const std::size_t room = data.size() / 2 + 120;
  const auto kept = std::make_unique<g4lidar::point[]>(room);
  std::size_t points = decode(data, {kept.get(), room});  // the memory is there now
  double begin = seconds();
  for (int i = 0; i < repetitions; ++i) points = decode(data, {kept.get(), room});
  const auto all = static_cast<double>(points) * repetitions;
  std::printf("reused %.0f\n", all / (seconds() - begin));
  begin = seconds();
  for (int i = 0; i < repetitions; ++i) {
    const std::unique_ptr<void, void (*)(void*)> fresh(std::malloc(room * sizeof(g4lidar::point)),
                                                       std::free);
    points = decode(data, {static_cast<g4lidar::point*>(fresh.get()), room});
  }
  std::printf("new %.0f\n", all / (seconds() - begin));
}
