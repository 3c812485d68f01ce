// SPDX-License-Identifier: MIT
#include "g4lidar/recording/digest.hpp"
#include "g4lidar/bulk_decoder.hpp"

namespace g4lidar {

std::string_view computed_with() noexcept {
  [[maybe_unused]] const bool has_avx2 = best_instruction_set() == instruction_set::avx2;
#if defined(__x86_64__)
  return has_avx2 ? "x86_64 avx2" : "x86_64";
#elif defined(__aarch64__)
  return "aarch64";
#elif defined(__arm__)
  return "arm";
#elif defined(__i386__)
  return "i386";
#elif defined(__riscv)
  return "riscv";
#elif defined(__s390x__)
  return "s390x";
#else
  return has_avx2 ? "avx2" : "portable";
#endif
}

}  // namespace g4lidar
