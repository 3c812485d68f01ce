// SPDX-License-Identifier: MIT
// Without memory a function fails with G4LIDAR_NO_MEMORY: every allocation of a call fails once.
#include <atomic>
#include <cstdlib>
#include <functional>
#include <new>
#include <string>
#include <utility>

#include "c/c_handles.hpp"

namespace {

// The allocation that fails, counted down; below 0: none. Only the thread of the test fails.
thread_local long left = -1;

void* allocated(std::size_t size, std::size_t alignment) {
  if (left >= 0 && left-- == 0) return nullptr;
  if (alignment <= alignof(std::max_align_t)) return std::malloc(size == 0 ? 1 : size);
  return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* allocated_or_throw(std::size_t size, std::size_t alignment) {
  void* const memory = allocated(size, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

// The shared library uses them, too.
void* operator new(std::size_t n) { return allocated_or_throw(n, 1); }
void* operator new(std::size_t n, std::align_val_t a) {
  return allocated_or_throw(n, static_cast<std::size_t>(a));
}
void* operator new(std::size_t n, const std::nothrow_t&) noexcept { return allocated(n, 1); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

namespace {

using namespace g4lidar_c_test;

/// Calls `run` with each of its allocations failing, until none fails. Returns how many failed; each
/// failed call ends with no_memory, or repairs it by itself.
long failures_of(const std::function<int(g4lidar_error&)>& run) {
  for (long failing = 0; failing < 10'000; ++failing) {
    g4lidar_error why;
    left = failing;
    const int code = run(why);
    const bool has_failed = left < 0;
    left = -1;
    if (!has_failed) {
      EXPECT_EQ(code, G4LIDAR_OK) << why.message;
      return failing;
    }
    if (code != G4LIDAR_OK) {
      EXPECT_EQ(code, G4LIDAR_NO_MEMORY) << failing << ": " << why.message;
      EXPECT_STREQ(why.message, "no memory is left.");
    }
  }
  return -1;
}

TEST(CMemory, OfASimulator) {
  EXPECT_GT(failures_of([](g4lidar_error& why) {
              g4lidar_simulator_options options;
              g4lidar_simulator_options_init(&options, sizeof options);
              options.virtual_time = true;
              options.setup = "sim:?seed=7&fault=unplug@5s";
              g4lidar_simulator* made = nullptr;
              const int code = g4lidar_simulator_create(&options, &made, &why);
              EXPECT_EQ(made == nullptr, code != G4LIDAR_OK);
              g4lidar_simulator_free(made);
              return code;
            }),
            5);
}

TEST(CMemory, OfALidar) {
  const simulator device = simulate();
  EXPECT_GT(failures_of([&](g4lidar_error& why) {
              g4lidar_lidar* made = nullptr;
              const int code = g4lidar_open_simulated(device.get(), nullptr, &made, &why);
              EXPECT_EQ(made == nullptr, code != G4LIDAR_OK);
              g4lidar_free(made);
              return code;
            }),
            5);
}

TEST(CMemory, OfARecordingAndItsReader) {
  const scratch directory;
  const std::string path = directory.path("walk.mcap");
  g4lidar_recorder_options options;
  g4lidar_recorder_options_init(&options, sizeof options);
  options.overwrite = true;
  EXPECT_GT(failures_of([&](g4lidar_error& why) {
              g4lidar_recorder* made = nullptr;
              const int code = g4lidar_recorder_create(path.c_str(), &options, &made, &why);
              EXPECT_EQ(made == nullptr, code != G4LIDAR_OK);
              const long kept = std::exchange(left, -1);  // closing the file is not examined
              g4lidar_recorder_free(made);
              left = kept;
              return code;
            }),
            5);
}

}  // namespace
