// SPDX-License-Identifier: MIT
// Feeds the parser with expensive input, for bench/worst_case.sh to count instructions; and
// searches for more expensive input.
//
//   worst_case list                         the names of the inputs
//   worst_case run NAME PIECE BYTES [MODEL] parses BYTES bytes of that input in pieces of PIECE
//   worst_case hex NAME                     one period of it
//   worst_case search SECONDS SEED PIECE    searches; prints the most expensive ones in hex and ns/byte
//   worst_case run HEX PIECE BYTES          like above, with the period HEX
#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "g4lidar/core/model.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace {

using buffer = std::vector<std::uint8_t>;

/// A period of input, to be repeated.
struct input {
  const char* name;
  const char* what;
  buffer period;
};

buffer repeated(const buffer& unit, std::size_t count) {
  buffer out;
  for (std::size_t i = 0; i < count; ++i) out.insert(out.end(), unit.begin(), unit.end());
  return out;
}

void seal(buffer& packet) {
  const std::uint16_t sum = g4lidar::packet_checksum(packet);
  packet[8] = static_cast<std::uint8_t>(sum & 0xFFU);
  packet[9] = static_cast<std::uint8_t>(sum >> 8);
}

/// A valid packet of `samples` samples.
buffer good(std::size_t samples) {
  buffer out(10 + 2 * samples, 0x11);
  const std::array<std::uint8_t, 8> header{0xAA, 0x55, 0,    static_cast<std::uint8_t>(samples),
                                           0x01, 0x10, 0x01, 0x12};
  std::copy(header.begin(), header.end(), out.begin());
  seal(out);
  return out;
}

buffer from_hex(std::string_view hex) {
  buffer out;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    out.push_back(
        static_cast<std::uint8_t>(std::stoul(std::string(hex.substr(i, 2)), nullptr, 16)));
  }
  return out;
}

std::vector<input> inputs() {
  const buffer info{0xA5, 0x5A, 0x14, 0, 0, 0, 4, 5, 2, 3, 3, 1, 2,
                    3,    4,    5,    6, 7, 8, 9, 1, 2, 3, 4, 5, 6};
  buffer broken_info = info;
  broken_info.push_back(10);
  buffer true_info = info;
  true_info.push_back(9);
  return {
      {"clean_80", "good packets of 80 samples, for comparison", good(80)},
      {"clean_1", "good packets of one sample", good(1)},
      {"noise", "bytes that begin nothing", buffer(64, 0x33)},
      {"overlapping_headers",
       "a header of 80 samples every 5 bytes, the densest there is: each lies in the angles of the "
       "one before, and each checksum runs over 170 bytes and fails",
       {0xAA, 0x55, 0x00, 0x50, 0x01}},
      {"overlapping_79",
       "the same with 79 samples: the checksum's loop ends unevenly",
       {0xAA, 0x55, 0x00, 0x4F, 0x01}},
      {"overlapping_40",
       "the same with 40 samples, the most of other models: of 3 bytes, the checksum runs over 130 "
       "bytes",
       {0xAA, 0x55, 0x00, 0x28, 0x01}},
      {"headers_8",
       "a header of 79 samples every 8 bytes",
       {0xAA, 0x55, 0x00, 0x4F, 0x01, 0x10, 0x01, 0x12}},
      {"aa", "nothing but AA", {0xAA}},
      {"a5", "nothing but A5", {0xA5}},
      {"aa_a5", "AA and A5 in turn", {0xAA, 0xA5}},
      {"aa_55", "the start of a packet again and again", {0xAA, 0x55}},
      {"aa_66", "the start of a time packet again and again", {0xAA, 0x66}},
      {"time_packets", "true time packets", {0xAA, 0x66, 0xDC, 0x10, 0x20, 0x30, 0x10, 0x00}},
      {"a5_5a", "the start of a reply again and again", {0xA5, 0x5A}},
      {"noise_and_a5", "noise of one byte between false starts", {0xA5, 0x00}},
      {"reply_headers",
       "headers of replies that break off at the type",
       {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00}},
      {"info_refused_at_its_end", "device informations whose last serial digit is 10", broken_info},
      {"info", "true device informations", true_info},
      {"bytes", "replies of one byte", {0xA5, 0x5A, 1, 0, 0, 0, 4, 1}},
      {"info_in_info", "found by searching: device informations that hold another's header",
       from_hex("A55A1400000004A55A140000000406090250010203040406070809010204030909")},
      {"pieces_of_info", "found by searching: the same, refused and begun again",
       from_hex(
           "A55A1400000004054FAA55060102030405070809010203040505A55A14000000040403AA550601020305"
           "05070809010203040509")},
      {"info_in_header",
       "as overlapping_headers, a reply's header in each gap",
       {0xAA, 0x55, 0x00, 0x50, 0x01, 0xA5, 0x5A, 0x14}},
  };
}

std::size_t checksum_of_events = 0;  // so that the work is not optimised away

void parse(const buffer& data, std::size_t piece,
           g4lidar::sample_format format = g4lidar::g4_format) {
  g4lidar::stream_parser parser(format);
  std::size_t sum = 0;
  for (std::size_t from = 0; from < data.size(); from += piece) {
    parser.feed(g4lidar::bytes(data).subspan(from, std::min(piece, data.size() - from)),
                [&](const g4lidar::event& found) { sum += 1 + found.index(); });
  }
  while (const auto found = parser.finish()) sum += 1 + found->index();
  checksum_of_events += sum;
}

buffer stretched(const buffer& period, std::size_t size) {
  buffer data = repeated(period, size / period.size() + 1);
  data.resize(size);
  return data;
}

double ns_per_byte(const buffer& period, std::size_t piece, int tries) {
  const buffer data = stretched(period, 3000);
  double best = 1e9;
  for (int i = 0; i < tries; ++i) {
    const auto before = std::chrono::steady_clock::now();
    parse(data, piece);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - before;
    best = std::min(best, took.count() / static_cast<double>(data.size()));
  }
  return best;
}

std::string to_hex(const buffer& data) {
  std::string out;
  for (const std::uint8_t byte : data) {
    std::array<char, 3> digits{};
    std::snprintf(digits.data(), digits.size(), "%02X", unsigned{byte});
    out += digits.data();
  }
  return out;
}

/// Changes, inserts, removes and joins bytes that have a meaning for the parser.
class mutator {
 public:
  explicit mutator(unsigned seed) : random_(seed) {}

  /// An input derived from one of `known`, or rarely from a single byte.
  buffer make(const std::vector<buffer>& known) {
    buffer made = below(20) == 0 ? buffer{structural_byte()} : one_of(known);
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(made, known);
    return made;
  }

 private:
  void change(buffer& made, const std::vector<buffer>& known) {
    const auto place = static_cast<std::ptrdiff_t>(below(made.size() + 1));
    const auto at = made.begin() + place;
    switch (below(5)) {
      case 0:
        made.insert(at, structural_byte());
        break;
      case 1:
        if (made.size() > 1 && at != made.end()) made.erase(at);
        break;
      case 2:
        if (at != made.end()) *at = structural_byte();
        break;
      case 3:
        join(made, place, one_of(chunks));
        break;
      default:
        join(made, place, buffer(one_of(known)));
        break;
    }
  }
  static void join(buffer& made, std::ptrdiff_t place, const buffer& more) {
    made.insert(made.begin() + place, more.begin(), more.end());
  }

  std::size_t below(std::size_t n) { return std::size_t{random_() % n}; }
  std::uint8_t structural_byte() { return structural[below(structural.size())]; }
  const buffer& one_of(const std::vector<buffer>& all) { return all[below(all.size())]; }

  static constexpr std::array<std::uint8_t, 20> structural{0xAA, 0x55, 0xA5, 0x5A, 0x00, 0x01, 0x03,
                                                           0x04, 0x05, 0x06, 0x14, 0x40, 0x81, 0x50,
                                                           0x4F, 0x28, 0x09, 0x0A, 0xB3, 0x11};
  const std::vector<buffer> chunks{
      {0xAA, 0x55, 0x00, 0x50, 0x01}, {0xAA, 0x55, 0x00, 0x4F, 0x01, 0x10, 0x01, 0x12},
      {0xA5, 0x5A, 0x14, 0, 0, 0, 4}, {0xA5, 0x5A, 0x04, 0, 0, 0, 4, 0},
      {0xA5, 0x5A, 0x03, 0, 0, 0, 6}, {0xA5, 0x5A, 0x05, 0, 0}};
  std::mt19937 random_;
};

/// The most expensive periods found, the most expensive one first.
class pool {
 public:
  explicit pool(std::size_t piece) : piece_(piece) {
    for (const input& known : inputs()) {
      if (!known.period.empty()) keep(known.period, 5);
    }
  }

  [[nodiscard]] const std::vector<buffer>& periods() const { return periods_; }

  /// Keeps `period` if it costs more than the cheapest one here.
  void offer(const buffer& period) {
    if (ns_per_byte(period, piece_, 3) <= costs_.back()) return;
    keep(period, 20);
    if (periods_.size() <= 24) return;
    periods_.pop_back();
    costs_.pop_back();
  }

  /// Measures all of them again, more exactly.
  void measure_again() {
    const std::vector<buffer> all = std::exchange(periods_, {});
    costs_.clear();
    for (const buffer& period : all) keep(period, 50);
  }

  void print(std::size_t most) const {
    for (std::size_t i = 0; i < std::min(most, periods_.size()); ++i) {
      std::printf("%.2f %s\n", costs_[i], to_hex(periods_[i]).c_str());
    }
  }

 private:
  void keep(const buffer& period, int tries) {
    const double cost = ns_per_byte(period, piece_, tries);
    const auto place = std::upper_bound(costs_.begin(), costs_.end(), cost, std::greater<>());
    periods_.insert(periods_.begin() + (place - costs_.begin()), period);
    costs_.insert(place, cost);
  }

  std::size_t piece_;
  std::vector<buffer> periods_;
  std::vector<double> costs_;  // ns per byte, of each of them
};

/// Searches from all known inputs to more expensive ones.
void search(double seconds, unsigned seed, std::size_t piece) {
  mutator changes(seed);
  pool dearest(piece);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end) {
    const buffer next = changes.make(dearest.periods());
    if (next.size() <= 400) dearest.offer(next);
  }
  dearest.measure_again();
  dearest.print(5);
}

buffer period_of(std::string_view name) {
  for (const input& known : inputs()) {
    if (name == known.name) return known.period;
  }
  return from_hex(name);
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  if (words.size() == 1 && words[0] == "list") {
    for (const input& known : inputs()) std::printf("%s\t%s\n", known.name, known.what);
  } else if (words.size() == 2 && words[0] == "hex") {
    std::printf("%s\n", to_hex(period_of(words[1])).c_str());
  } else if ((words.size() == 4 || words.size() == 5) && words[0] == "run") {
    const g4lidar::model* const which = g4lidar::model_named(words.size() == 5 ? words[4] : "g4");
    if (which == nullptr) {
      std::fprintf(stderr, "no model has this name: %s\n", words[4].c_str());
      return 2;
    }
    parse(stretched(period_of(words[1]), std::stoul(words[3])), std::stoul(words[2]),
          which->samples);
    std::printf("%zu\n", checksum_of_events);
  } else if (words.size() == 4 && words[0] == "search") {
    search(std::stod(words[1]), static_cast<unsigned>(std::stoul(words[2])), std::stoul(words[3]));
  } else {
    std::fprintf(stderr, "usage: see the head of worst_case.cpp\n");
    return 2;
  }
  return 0;
}
