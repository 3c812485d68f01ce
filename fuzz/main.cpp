// SPDX-License-Identifier: MIT
// The main() of the fuzz targets without libFuzzer: runs each given file and each file in each
// given directory; and after a directory, G4LIDAR_TEST_SCALE times 2000 inputs derived from its
// files by a seeded generator. A failure aborts, after the name of the input was printed.
#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

namespace fs = std::filesystem;
using buffer = std::vector<std::uint8_t>;

std::string current;  // the running input, for messages
buffer current_bytes;

extern "C" void print_what_failed(int) {
  std::fprintf(stderr, "failed: %s; its bytes:\n", current.c_str());
  for (const unsigned byte : current_bytes) std::fprintf(stderr, "%02x", byte);
  std::fprintf(stderr, "\n");
  std::_Exit(1);
}

void run(std::string name, const buffer& input) {
  current = std::move(name);
  current_bytes = input;
  // Memory of exactly this size, so that a sanitizer detects a read behind its end.
  const buffer exact(input.begin(), input.end());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

buffer read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    std::fprintf(stderr, "cannot read %s\n", path.c_str());
    std::exit(2);
  }
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// G4LIDAR_TEST_SEED, which the nightly sets to a new number each day.
unsigned given_seed() {
  const char* const given = std::getenv("G4LIDAR_TEST_SEED");
  return given == nullptr ? 0U : static_cast<unsigned>(std::atoll(given));
}

/// A new input from old ones: truncated, joined, repeated, and with some changed bytes.
class generator {
 public:
  explicit generator(const std::vector<buffer>& seeds) : seeds_(seeds) {}

  buffer next() {
    buffer out;
    for (std::size_t parts = 1 + below(3); parts > 0; --parts) {
      if (seeds_.empty() || below(8) == 0) {
        for (std::size_t n = below(64); n > 0; --n) out.push_back(byte());
        continue;
      }
      const buffer& seed = seeds_[below(seeds_.size())];
      const std::size_t from = below(4) == 0 ? below(seed.size() + 1) : 0;
      const std::size_t count = below(4) == 0 ? below(seed.size() - from + 1) : seed.size() - from;
      const auto first = seed.begin() + static_cast<std::ptrdiff_t>(from);
      out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(count));
    }
    for (std::size_t changes = below(8); changes > 0 && !out.empty(); --changes) change(out);
    return out;
  }

 private:
  std::size_t below(std::size_t n) { return static_cast<std::uint32_t>(random_() % n); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_() & 0xFFU); }

  void change(buffer& out) {
    const std::size_t at = below(out.size());
    const auto place = out.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(4)) {
      case 0:
        *place = byte();
        return;
      case 1:
        *place = static_cast<std::uint8_t>(*place ^ 1U << below(8));
        return;
      case 2:
        out.erase(place);
        return;
      default:
        out.insert(place, byte());
        return;
    }
  }

  const std::vector<buffer>& seeds_;
  std::mt19937 random_{20210101U + given_seed()};
};

}  // namespace

int main(int count, char** arguments) {
  std::signal(SIGABRT, print_what_failed);
  std::vector<buffer> seeds;
  bool generate = false;
  for (int i = 1; i < count; ++i) {
    const fs::path given(arguments[i]);
    std::vector<fs::path> files;
    if (fs::is_directory(given)) {
      generate = true;
      for (const auto& entry : fs::directory_iterator(given)) files.push_back(entry.path());
      std::sort(files.begin(), files.end());
    } else {
      files.push_back(given);
    }
    for (const fs::path& file : files) {
      seeds.push_back(read_file(file));
      run(file.string(), seeds.back());
    }
  }
  const char* const scale = std::getenv("G4LIDAR_TEST_SCALE");
  const int generated =
      generate ? 2000 * (scale != nullptr ? std::max(1, std::atoi(scale)) : 1) : 0;
  generator inputs(seeds);
  for (int i = 0; i < generated; ++i) run("generated input " + std::to_string(i), inputs.next());
  std::printf("%zu files and %d generated inputs\n", seeds.size(), generated);
  return 0;
}
