// SPDX-License-Identifier: MIT
// simulation_run: Runs the driver on the simulated device in virtual time, with all that a seed draws.
//
//     simulation_run --seed 7 --verbose              one run, and what happens in it
//     simulation_run --from 1 --count 100 --jobs 2   a hundred, two at a time
//     simulation_run --from 1 --minutes 3 --jobs 2   as many as there is time for
//     simulation_run --from 1 --count 8 --models     each model with some of these seeds
//     simulation_run --seed 7 --model x4 --verbose   one of them
//     simulation_run --unplugs 10000                 a single long one, unplugged again and again
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "g4lidar/sim/device_options.hpp"
#include "simulation/simulation_run.hpp"
#include "simulation/soak.hpp"
#include "simulation/summary.hpp"

namespace {

using namespace g4lidar::simulation;

struct arguments {
  std::uint64_t from = 1;
  std::uint64_t count = 1;
  std::uint64_t jobs = 1;
  std::uint64_t unplugs = 0;
  double minutes = 0.0;  // 0: `count` of them
  bool verbose = false;
  std::string_view model;  // empty: a G4 with all that is not known of it
  bool every_model = false;
  bool good = true;
};

arguments read_arguments(int count, char** words) {
  arguments read;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    const char* const value = i + 1 < count ? words[i + 1] : nullptr;
    const auto number = [&] { return std::strtoull(words[++i], nullptr, 10); };
    if (word == "--verbose") {
      read.verbose = true;
    } else if (word == "--models") {
      read.every_model = true;
    } else if (value == nullptr) {
      read.good = false;
    } else if (word == "--model") {
      read.model = words[++i];
      read.good = read.good && std::ranges::find(g4lidar::sim::model_words(), read.model) !=
                                   g4lidar::sim::model_words().end();
    } else if (word == "--seed" || word == "--from") {
      read.from = number();
    } else if (word == "--count") {
      read.count = number();
    } else if (word == "--unplugs") {
      read.unplugs = number();
    } else if (word == "--jobs") {
      read.jobs = std::max<std::uint64_t>(number(), 1);
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

/// The runs are independent of each other, in `jobs` threads, and added up together.
summary run_all(const arguments& wanted, const char* program) {
  using clock = std::chrono::steady_clock;
  const auto end = clock::now() + std::chrono::duration<double, std::ratio<60>>(wanted.minutes);
  summary all;
  std::mutex one_at_a_time;
  std::atomic<std::uint64_t> next = 0;
  const auto work = [&] {
    while (wanted.minutes <= 0.0 || clock::now() < end) {
      const std::uint64_t index = next++;
      const auto models = g4lidar::sim::model_words();
      const std::uint64_t in_turn = wanted.every_model ? models.size() : 1;
      if (wanted.minutes <= 0.0 && index >= wanted.count * in_turn) return;
      const std::uint64_t seed = wanted.from + index / in_turn;
      const std::string_view model = wanted.every_model ? models[index % in_turn] : wanted.model;
      const run_parameters parameters = draw_run(seed, model);
      const run_report report = run_simulation(parameters, wanted.verbose);
      const std::lock_guard lock(one_at_a_time);
      all.add(parameters, report);
      if (report.failure.empty()) continue;
      std::printf("run %llu failed at %.6f s: %s\n  again: %s --seed %llu%s%.*s --verbose\n",
                  static_cast<unsigned long long>(seed),
                  static_cast<double>(report.failed_ns) * 1e-9, report.failure.c_str(), program,
                  static_cast<unsigned long long>(seed), model.empty() ? "" : " --model ",
                  static_cast<int>(model.size()), model.data());
      std::fflush(stdout);
    }
  };
  std::vector<std::jthread> others;
  for (std::uint64_t i = 1; i < wanted.jobs; ++i) others.emplace_back(work);
  work();
  others.clear();
  return all;
}

}  // namespace

int main(int count, char** words) {
  const arguments wanted = read_arguments(count, words);
  if (!wanted.good) {
    std::fputs(
        "usage: simulation_run [--seed N | --from N] [--count N | --minutes M] [--jobs N] "
        "[--model WORD | --models] [--verbose] [--unplugs N]\n",
        stderr);
    return 2;
  }
  if (wanted.unplugs > 0) return run_soak(wanted.unplugs);
  const summary all = run_all(wanted, words[0]);
  std::fputs(all.text().c_str(), stdout);
  if (const std::string wrong = all.problem(); !wrong.empty()) {
    std::printf("over all runs: %s\n", wrong.c_str());
    return 1;
  }
  return all.failed() > 0 ? 1 : 0;
}
