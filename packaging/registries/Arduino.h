// SPDX-License-Identifier: MIT
// As much of Arduino as lidar.ino uses, with which scripts/ci/registries compiles it.
#pragma once
#include <cstddef>
#include <cstdint>

#define bit(number) (1UL << (number))
#define degrees(radians) ((radians) * 57.29577951308232)

struct HardwareSerial {
  void begin(unsigned long baud);
  int available(), read();
  std::size_t write(const std::uint8_t* data, std::size_t size);
  std::size_t print(const char* text), print(double number), println(double number);
};
extern HardwareSerial Serial, Serial1;
unsigned long millis();
