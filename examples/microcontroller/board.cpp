// SPDX-License-Identifier: MIT
// The board MPS2 with a Cortex-M4F (image AN386), as emulated by QEMU: its start-up, two of its
// serial ports, and the processor's timer. The lidar is connected to the first port, the console to
// the second.
#include "board.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

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

constexpr std::uint32_t clock_hz = 25'000'000;
constexpr std::uint32_t lidar_baud = 230'400;

// ---- registers ---------------------------------------------------------------------------------
volatile std::uint32_t& device_register(std::uintptr_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}

/// A serial port of the CMSDK: a buffer of one byte in each direction.
struct uart {
  std::uintptr_t base;

  static constexpr std::uint32_t transmitter_full = 1U << 0;
  static constexpr std::uint32_t receiver_full = 1U << 1;
  static constexpr std::uint32_t receiver_overrun = 1U << 3;
  static constexpr std::uint32_t transmit = 1U << 0;
  static constexpr std::uint32_t receive = 1U << 1;
  static constexpr std::uint32_t receive_interrupt = 1U << 3;

  [[nodiscard]] volatile std::uint32_t& data() const { return device_register(base); }
  [[nodiscard]] volatile std::uint32_t& state() const { return device_register(base + 0x04); }
  [[nodiscard]] volatile std::uint32_t& control() const { return device_register(base + 0x08); }
  [[nodiscard]] volatile std::uint32_t& interrupts() const { return device_register(base + 0x0C); }
  [[nodiscard]] volatile std::uint32_t& divisor() const { return device_register(base + 0x10); }

  void put(std::uint8_t byte) const {
    while ((state() & transmitter_full) != 0) {
    }
    data() = byte;
  }
};

constexpr uart lidar{0x40004000};
constexpr uart console{0x40005000};
constexpr std::uint32_t lidar_receives = 0;  // the number of its interrupt

// ---- interrupts --------------------------------------------------------------------------------
volatile std::uint32_t ticks = 0;
volatile std::uint32_t overruns = 0;

void on_tick() { ticks = ticks + 1; }

void on_lidar_received() {
  lidar.interrupts() =
      uart::receive;  // acknowledge first; then read the byte, so that none is missed
  if ((lidar.state() & uart::receiver_overrun) != 0) {
    lidar.state() = uart::receiver_overrun;
    overruns = overruns + 1;
  }
  if ((lidar.state() & uart::receiver_full) != 0) {
    on_lidar_byte(static_cast<std::uint8_t>(lidar.data()));
  }
}

void fault() {
  board::print("fault: the processor refused an instruction or an access\n");
  board::end(3);
}

}  // namespace

// ---- start-up ----------------------------------------------------------------------------------
extern "C" void (*const vectors[17])();
[[gnu::used, gnu::section(".vectors")]] void (*const vectors[17])() = {stack_top,
                                                                       reset,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       fault,
                                                                       on_tick,
                                                                       on_lidar_received};

extern "C" void reset() {
  device_register(0xE000ED88) = device_register(0xE000ED88) | (0xFU << 20);  // CPACR: the FPU on
  asm volatile("dsb\n isb" ::: "memory");
  std::copy(data_image, data_image + (data_end - data_begin), data_begin);
  std::fill(bss_begin, bss_end, 0U);
  for (auto* constructor = init_array_begin; constructor != init_array_end; ++constructor) {
    (*constructor)();
  }
  board::end(main());
}

// ---- the board ---------------------------------------------------------------------------------
namespace board {

void begin() {
  // The divisor is rounded up: 229,358 baud, half a percent below the rate, which is within the
  // tolerance of a byte.
  lidar.divisor() = (clock_hz + lidar_baud - 1) / lidar_baud;
  console.divisor() = clock_hz / 115'200;
  console.control() = uart::transmit;
  device_register(0xE000E014) = clock_hz / 1000 - 1;  // SysTick: every millisecond
  device_register(0xE000E018) = 0;
  device_register(0xE000E010) = 7;  // on, with an interrupt, by the processor's clock
  device_register(0xE000E100) = 1U << lidar_receives;  // NVIC: enabled
  lidar.control() = uart::transmit | uart::receive | uart::receive_interrupt;
}

std::int64_t now_ns() {
  static std::uint32_t last = 0;
  static std::int64_t now_ms = 0;
  const std::uint32_t now = ticks;
  now_ms += now - last;  // the ticks wrap after 49 days, this does not
  last = now;
  return now_ms * 1'000'000;
}

void send(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) lidar.put(byte);
}

void print(std::string_view text) {
  for (const char letter : text) console.put(static_cast<std::uint8_t>(letter));
}

void sleep() { asm volatile("wfi" ::: "memory"); }

std::uint32_t receiver_overruns() { return overruns; }

void end(int code) {
  // Semihosting, SYS_EXIT_EXTENDED: the emulator ends with this code. A real board stops here.
  const std::array<std::uint32_t, 2> status{0x20026, static_cast<std::uint32_t>(code)};
  register std::uint32_t operation asm("r0") = 0x20;
  register const void* argument asm("r1") = status.data();
  asm volatile("bkpt 0xAB" : "+r"(operation) : "r"(argument) : "memory");
  while (true) sleep();
}

}  // namespace board
