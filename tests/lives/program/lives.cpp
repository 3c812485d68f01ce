// SPDX-License-Identifier: MIT
// lives: Lives lives of the driver on the simulated device, from their seeds.
//
//     lives --seed 7 --verbose           one life, and what happens in it
//     lives --from 1 --count 100         a hundred
//     lives --from 1 --step 2 --minutes 3   every second one, as many as there is time for
//     lives --unplugs 10000              a single long one, unplugged again and again
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "lives/life.hpp"
#include "lives/soak.hpp"
#include "lives/summary.hpp"

namespace {

using namespace g4lidar::lives;

struct wishes {
  std::uint64_t from = 1;
  std::uint64_t count = 1;
  std::uint64_t step = 1;
  std::uint64_t unplugs = 0;
  double minutes = 0.0;  // 0: `count` of them
  bool verbose = false;
  bool good = true;
};

wishes read_wishes(int count, char** words) {
  wishes read;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    const char* const value = i + 1 < count ? words[i + 1] : nullptr;
    const auto number = [&] { return std::strtoull(words[++i], nullptr, 10); };
    if (word == "--verbose") {
      read.verbose = true;
    } else if (value == nullptr) {
      read.good = false;
    } else if (word == "--seed" || word == "--from") {
      read.from = number();
    } else if (word == "--count") {
      read.count = number();
    } else if (word == "--unplugs") {
      read.unplugs = number();
    } else if (word == "--step") {
      read.step = number();
    } else if (word == "--minutes") {
      read.minutes = std::strtod(words[++i], nullptr);
    } else {
      read.good = false;
    }
  }
  return read;
}

int run_soak(std::uint64_t unplugs) {
  const soak_report soaked = soak(unplugs);
  std::printf(
      "%llu unplugs, came back %llu times, after %.3f s at the latest; memory grown by %lld bytes, "
      "%lld descriptors\n",
      static_cast<unsigned long long>(soaked.unplugs),
      static_cast<unsigned long long>(soaked.reconnects),
      static_cast<double>(soaked.slowest_ns) * 1e-9, static_cast<long long>(soaked.grown_bytes),
      static_cast<long long>(soaked.grown_handles));
  if (soaked.failure.empty()) return 0;
  std::printf("failed: %s\n", soaked.failure.c_str());
  return 1;
}

}  // namespace

int main(int count, char** words) {
  const wishes wanted = read_wishes(count, words);
  if (!wanted.good) {
    std::fputs(
        "usage: lives [--seed N | --from N] [--count N | --minutes M] [--step N] [--verbose] "
        "[--unplugs N]\n",
        stderr);
    return 2;
  }
  if (wanted.unplugs > 0) return run_soak(wanted.unplugs);
  using clock = std::chrono::steady_clock;
  const auto end = clock::now() + std::chrono::duration<double, std::ratio<60>>(wanted.minutes);
  summary all;
  for (std::uint64_t i = 0; wanted.minutes > 0.0 ? clock::now() < end : i < wanted.count; ++i) {
    const std::uint64_t seed = wanted.from + i * wanted.step;
    const life_plan plan = draw_life(seed);
    const life_report lived = live(plan, wanted.verbose);
    all.add(plan, lived);
    if (lived.failure.empty()) continue;
    std::printf("life %llu failed at %.6f s: %s\n  again: %s --seed %llu --verbose\n",
                static_cast<unsigned long long>(seed), static_cast<double>(lived.failed_ns) * 1e-9,
                lived.failure.c_str(), words[0], static_cast<unsigned long long>(seed));
    std::fflush(stdout);
  }
  std::fputs(all.text().c_str(), stdout);
  if (const std::string wrong = all.problem(); !wrong.empty()) {
    std::printf("over all lives: %s\n", wrong.c_str());
    return 1;
  }
  return all.failed() > 0 ? 1 : 0;
}
