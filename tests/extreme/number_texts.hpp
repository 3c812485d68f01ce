// SPDX-License-Identifier: MIT
// Extreme numbers as text.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "support/random_stream.hpp"

namespace g4lidar::extreme {

inline const std::vector<std::string> numbers{"0",
                                              "-0",
                                              "1",
                                              "-1",
                                              "0.5",
                                              "1e-320",
                                              "1e-45",
                                              "1e30",
                                              "-1e30",
                                              "1e308",
                                              "1e309",
                                              "-1e400",
                                              "nan",
                                              "-nan",
                                              "inf",
                                              "-inf",
                                              "infinity",
                                              "255",
                                              "256",
                                              "65535",
                                              "65536",
                                              "2147483647",
                                              "2147483648",
                                              "-2147483648",
                                              "4294967295",
                                              "4294967296",
                                              "9223372036854775807",
                                              "9223372036854775808",
                                              "-9223372036854775808",
                                              "-9223372036854775809",
                                              "18446744073709551615",
                                              "18446744073709551616",
                                              "99999999",
                                              "100000000",
                                              "99999.9999",
                                              "1e5",
                                              "0x7f",
                                              "1e",
                                              "360",
                                              "359.99999",
                                              "1000",
                                              "1e3"};

inline std::string any_number(test::dice& random) { return numbers[random.below(numbers.size())]; }

inline std::string any_numbers(test::dice& random, std::size_t count, const std::string& between) {
  std::string made = any_number(random);
  while (count-- > 1) made += between + any_number(random);
  return made;
}

}  // namespace g4lidar::extreme
