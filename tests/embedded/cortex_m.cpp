// SPDX-License-Identifier: MIT
// A Cortex-M without an operating system: start-up, output and exit by semihosting, and the only
// four functions that the core may use. There is no heap: code that allocates does not link.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "check.hpp"
#include "interrupts.hpp"

int main();

// ---- the linker script's flags -----------------------------------------------------------------
extern "C" {
extern std::uint32_t data_begin[], data_end[], bss_begin[], bss_end[];
extern const std::uint32_t data_image[];
extern void (*const init_array_begin[])();
extern void (*const init_array_end[])();
void stack_top();
[[noreturn]] void reset();
}

namespace {

// ---- semihosting -------------------------------------------------------------------------------
constexpr std::uint32_t sys_write0 = 0x04;
constexpr std::uint32_t sys_exit_extended = 0x20;
constexpr std::uint32_t application_exit = 0x20026;

std::uint32_t ask_debugger(std::uint32_t operation, const void* argument) {
  register std::uint32_t r0 asm("r0") = operation;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

[[noreturn]] void leave(int code) {
  const std::array<std::uint32_t, 2> status{application_exit, static_cast<std::uint32_t>(code)};
  ask_debugger(sys_exit_extended, status.data());
  while (true) {
  }
}

[[noreturn]] void fault() {
  self_test::put("fault: the processor refused an instruction or an access\n");
  leave(3);
}

volatile std::uint32_t& device_register(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

// ---- the timer ---------------------------------------------------------------------------------
/// An interrupt after so many cycles; none for 0.
void set_timer(std::uint32_t cycles) {
  device_register(0xE000E010) = 0;         // SysTick: off
  device_register(0xE000ED04) = 1U << 25;  // ICSR: clears a pending interrupt
  if (cycles == 0) return;
  device_register(0xE000E014) = cycles - 1;  // reload
  device_register(0xE000E018) = 0;           // current
  device_register(0xE000E010) = 7;           // on, with an interrupt, by the processor's clock
}

std::uint32_t (*tick_handler)() = nullptr;

void on_tick() { set_timer(tick_handler()); }

}  // namespace

// ---- start-up ----------------------------------------------------------------------------------
extern "C" void (*const vectors[16])();
[[gnu::used, gnu::section(".vectors")]] void (*const vectors[16])() = {
    stack_top, reset, fault, fault, fault, fault, fault, fault,
    fault,     fault, fault, fault, fault, fault, fault, on_tick};

extern "C" void reset() {
#ifdef __ARM_FP
  device_register(0xE000ED88) = device_register(0xE000ED88) | (0xFU << 20);  // CPACR: the FPU on
  asm volatile("dsb\n isb" ::: "memory");
#endif
  std::copy(data_image, data_image + (data_end - data_begin), data_begin);
  std::fill(bss_begin, bss_end, 0U);
  for (auto* constructor = init_array_begin; constructor != init_array_end; ++constructor) {
    (*constructor)();
  }
  leave(main());
}

// ---- the functions that the core may use -------------------------------------------------------
// This file is compiled so that these loops do not become calls of themselves.
extern "C" void* memcpy(void* to, const void* from, std::size_t count) {
  auto* out = static_cast<std::uint8_t*>(to);
  const auto* in = static_cast<const std::uint8_t*>(from);
  for (std::size_t i = 0; i < count; ++i) out[i] = in[i];
  return to;
}

extern "C" void* memmove(void* to, const void* from, std::size_t count) {
  auto* out = static_cast<std::uint8_t*>(to);
  const auto* in = static_cast<const std::uint8_t*>(from);
  if (out <= in) return memcpy(to, from, count);
  for (std::size_t i = count; i-- > 0;) out[i] = in[i];
  return to;
}

extern "C" void* memset(void* to, int value, std::size_t count) {
  auto* out = static_cast<std::uint8_t*>(to);
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<std::uint8_t>(value);
  return to;
}

extern "C" int memcmp(const void* a, const void* b, std::size_t count) {
  const auto* left = static_cast<const std::uint8_t*>(a);
  const auto* right = static_cast<const std::uint8_t*>(b);
  for (std::size_t i = 0; i < count; ++i) {
    if (left[i] != right[i]) return left[i] - right[i];
  }
  return 0;
}

// ---- functions for the tests, not for the core -------------------------------------------------
extern "C" std::size_t strlen(const char* text) {
  std::size_t length = 0;
  while (text[length] != '\0') ++length;
  return length;
}

extern "C" void* memchr(const void* in, int value, std::size_t count) {
  const auto* data = static_cast<const std::uint8_t*>(in);
  for (std::size_t i = 0; i < count; ++i) {
    if (data[i] == static_cast<std::uint8_t>(value)) return const_cast<std::uint8_t*>(data + i);
  }
  return nullptr;
}

/// libstdc++'s string_view calls this for an index behind its end.
namespace std {
[[noreturn]] void __throw_out_of_range_fmt(const char* text, ...) {
  self_test::put(text);
  self_test::put("\n");
  leave(2);
}
}  // namespace std

/// newlib's assert() calls this.
extern "C" [[noreturn]] void __assert_func(const char* file, int line, const char*,
                                           const char* text) {
  self_test::put(file);
  self_test::put(":");
  self_test::put_number(static_cast<std::size_t>(line));
  self_test::put(": assertion failed: ");
  self_test::put(text);
  self_test::put("\n");
  leave(2);
}

// ---- the board ---------------------------------------------------------------------------------
namespace self_test {

void put(std::string_view text) {
  std::array<char, 64> line{};
  while (!text.empty()) {
    const std::size_t count = std::min(text.size(), line.size() - 1);
    std::copy_n(text.begin(), count, line.begin());
    line[count] = '\0';
    ask_debugger(sys_write0, line.data());
    text.remove_prefix(count);
  }
}

void start_ticks(std::uint32_t cycles, std::uint32_t (*handler)()) {
  tick_handler = handler;
  set_timer(cycles);
}

void stop_ticks() { set_timer(0); }

}  // namespace self_test
