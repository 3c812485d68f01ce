// SPDX-License-Identifier: MIT
// Names that name nothing, and texts about ports.
#include "discovery/port_words.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "g4lidar/lidar.hpp"

namespace g4lidar::test {
namespace {

/// What is written, and the name that is meant.
const std::vector<std::pair<std::string, std::string>>& meant_names() {
  static const std::vector<std::pair<std::string, std::string>> all{
      {"ttyUSB0", "/dev/ttyUSB0"},
      {"/ttyACM1", "/dev/ttyACM1"},
      {"dev/ttyUSB0", "/dev/ttyUSB0"},
      {"ttyTHS1", "/dev/ttyTHS1"},
      {"serial0", "/dev/serial0"},
      {"COM3", "/dev/ttyUSB0"},
      {"com12:", "/dev/ttyUSB0"},
      {R"(\\.\COM10)", "/dev/ttyUSB0"},
      {"udp:0.0.0.0:8889", "tcp:0.0.0.0:8889"},
      {"udp://robot:8889", "tcp:robot:8889"},
      {"socket://robot:4000", "tcp:robot:4000"},
      {"rfc2217://10.0.0.2:4000", "tcp:10.0.0.2:4000"},
      {"telnet://10.0.0.2", "tcp:10.0.0.2:PORT"},
      {"127.0.0.1:4000", "tcp:127.0.0.1:4000"},
      {"robot:4000", "tcp:robot:4000"},
      {"[::1]:4000", "tcp:[::1]:4000"},
      {"192.168.0.7", "tcp:192.168.0.7:PORT"},
      {"TCP:robot:4000", "tcp:robot:4000"},
      {"Serial:2021101000070073", "serial:2021101000070073"},
      {"2021101000070073", "serial:2021101000070073"},
      {"serial:/dev/ttyUSB0", "/dev/ttyUSB0"},
      {"serial:ttyUSB0", "/dev/ttyUSB0"},
      {"usb:ttyUSB0", "/dev/ttyUSB0"},
      {"1-1.4", "usb:1-1.4"},
      {"USB:1-1.4", "usb:1-1.4"},
      {"SIM:?model=x4", "sim:?model=x4"},
      {"sim", "sim:"},
      {"sim?model=x4", "sim:?model=x4"},
      {"null", "/dev/null"},
      // As labels, other systems and other programs write it.
      {"TTYUSB0", "/dev/ttyUSB0"},
      {"ttyusb1", "/dev/ttyUSB1"},
      {"/dev/ttyusb0", "/dev/ttyUSB0"},
      {"/Dev/TTYUSB0", "/dev/ttyUSB0"},
      {"/dev/TTYACM0", "/dev/ttyACM0"},
      {"/dev/USB0", "/dev/ttyUSB0"},
      {"/dev/usb3", "/dev/ttyUSB3"},
      {"USB0", "/dev/ttyUSB0"},
      {"usb 0", "/dev/ttyUSB0"},
      {"AMA0", "/dev/ttyAMA0"},
      {"acm1", "/dev/ttyACM1"},
      {"THS1", "/dev/ttyTHS1"},
      {"ttys7", "/dev/ttyS7"},
      {"Serial0", "/dev/serial0"},
      {"ttyACM0:", "/dev/ttyACM0"},
      {"ttyUSB0:230400", "/dev/ttyUSB0"},
      {"/dev/ttyUSB0:115200", "/dev/ttyUSB0"},
      {"/dev/ttyUSB0,128000", "/dev/ttyUSB0"},
      {"ttyUSB0@230400", "/dev/ttyUSB0"},
      {"/dev//ttyUSB5", "/dev/ttyUSB5"},
      {R"(\dev\ttyUSB0)", "/dev/ttyUSB0"},
      {R"("/dev/ttyUSB6")", "/dev/ttyUSB6"},
      {" /dev/ttyUSB6 ", "/dev/ttyUSB6"},
      {"'walk-of-nobody.mcap'", "walk-of-nobody.mcap"},
      {"tty:USB0", "/dev/ttyUSB0"},
      {"device:/dev/ttyUSB6", "/dev/ttyUSB6"},
      {"port=/dev/ttyUSB6", "/dev/ttyUSB6"},
      {"serial:///dev/ttyUSB0", "/dev/ttyUSB0"},
      {"usb:USB0", "/dev/ttyUSB0"},
      {"by-id/usb-Silicon_Labs", "/dev/serial/by-id/usb-Silicon_Labs"},
      {"dev/serial/by-id/usb-Silicon_Labs", "/dev/serial/by-id/usb-Silicon_Labs"},
      {"com3", "/dev/ttyUSB0"},
      {"COM3:115200", "/dev/ttyUSB0"},
      {R"(\\.\COM3)", "/dev/ttyUSB0"},
      {"/dev/cu.usbserial-10", "/dev/ttyUSB0"},
      {"/dev/tty.SLAB_USBtoUART", "/dev/ttyUSB0"},
      {"tcp:/robot:4000", "tcp:robot:4000"},
      {"tcp//robot:4000", "tcp:robot:4000"},
      {"https://robot:4000/", "tcp:robot:4000"},
      {"localhost", "tcp:localhost:PORT"},
      {"robot.local", "tcp:robot.local:PORT"},
      {"localhost:4000", "tcp:localhost:4000"},
  };
  return all;
}

TEST(PortWords, TheNameThatIsMeant) {
  for (const auto& [given, meant] : meant_names()) {
    EXPECT_EQ(meant_by(given), meant) << given;
    const auto port = select_port(given);
    ASSERT_FALSE(port) << given;
    EXPECT_EQ(port.error(), problem::bad_option) << given;
    EXPECT_EQ(port.error().detail(), error_detail::bad_name) << given;
    const auto made = lidar::open(given);
    ASSERT_FALSE(made) << given;
    // "?model=x4" behind the name is not part of it.
    const std::string name = meant.substr(0, meant.find('?'));
    EXPECT_NE(made.error().message().find("did you mean " + name + "?"), std::string::npos)
        << made.error().message();
  }
}

TEST(PortWords, OtherNamesAreLeftAlone) {
  for (const std::string name : {"/dev/ttyUSB7",
                                 "/dev/no-such-port",
                                 "walk.mcap",
                                 "bytes/raw.bin",
                                 "serial:2021101000070073",
                                 "usb:1-1.4",
                                 "no such file",
                                 "comet",
                                 "udp",
                                 "a:b",
                                 "file:COM3",
                                 "1-2-3",
                                 "/dev/ttyS97",
                                 "tcp:robot:4000",
                                 "usb",
                                 "S2",
                                 "USB",
                                 "-",
                                 R"(C:\walk.mcap)",
                                 "/dev/serial0-of-nobody"}) {
    EXPECT_EQ(meant_by(name), "") << name;
    EXPECT_FALSE(misspelled(name)) << name;
  }
}

TEST(PortWords, UdpIsNotSupported) {
  const auto made = lidar::open("udp:0.0.0.0:8889");
  ASSERT_FALSE(made);
  EXPECT_TRUE(made.error().message().starts_with(
      "finding udp:0.0.0.0:8889 (not supported; did you mean tcp:0.0.0.0:8889?): "
      "this does not name a lidar."))
      << made.error().message();
}

TEST(PortWords, TcpMayHaveSlashes) {
  const auto made = lidar::open("tcp://127.0.0.1:1");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error(), problem::cannot_connect) << made.error().message();
}

port_info port(std::string path, std::uint16_t vendor = 0, std::uint16_t product = 0) {
  port_info made;
  made.path = std::move(path);
  made.vendor_id = vendor;
  made.product_id = product;
  return made;
}

TEST(PortWords, Bridges) {
  const auto of = [](std::uint16_t vendor, std::uint16_t product) {
    return bridge_of(port("/dev/x", vendor, product));
  };
  EXPECT_EQ(of(0x0403, 0x6015), "FT231X");
  EXPECT_EQ(of(0x1a86, 0x7523), "CH340");
  EXPECT_EQ(of(0x067b, 0x2303), "PL2303");
  EXPECT_EQ(of(0x10c4, 0xea60), "CP2102");
  EXPECT_EQ(of(0, 0), "UART");
  EXPECT_EQ(of(0x1234, 0x5678), "USB");
  port_info named = port("/dev/x", 0x1234, 0x5678);
  named.product = "My bridge";
  EXPECT_EQ(bridge_of(named), "My bridge");
}

TEST(PortWords, ListsThePortsThatWereNotLookedAt) {
  const std::vector<port_info> others{port("/dev/rfcomm0"), port("/dev/ttyTHS1"),
                                      port("/dev/ttyUSB0", 0x0403, 0x6015),
                                      port("/dev/ttyUSB1", 0x1a86, 0x7523)};
  const error why = no_lidar(others, false);
  EXPECT_EQ(why, problem::no_port);
  EXPECT_EQ(why.detail(), error_detail::other_bridges);
  EXPECT_EQ(
      why.subject(),
      "a lidar (not looked at: /dev/ttyUSB0, FT231X; /dev/ttyUSB1, CH340; /dev/ttyTHS1, UART)");
  EXPECT_NE(why.message().find("`g4-dump doctor <port>`"), std::string::npos);
  EXPECT_NE(why.message().find("--all-ports"), std::string::npos);
  EXPECT_EQ(no_lidar(others, true).detail(), error_detail::usual)
      << "ports with such a bridge were searched";
  const error none = no_lidar({}, false);
  EXPECT_EQ(none.subject(), "");
  const std::vector<port_info> many(20, port("/dev/ttyTHS1"));
  const error of_many = no_lidar(many, false);
  EXPECT_TRUE(of_many.subject().ends_with(" ...)")) << of_many.subject();
}

TEST(PortWords, ConsolesAndBluetoothAreReserved) {
  for (const char* const path : {"/dev/rfcomm0", "/dev/console", "/dev/tty1"})
    EXPECT_TRUE(is_reserved(port(path))) << path;
  for (const char* const path : {"/dev/ttyUSB0", "/dev/ttyACM0", "/dev/ttyTHS1"}) {
    EXPECT_FALSE(is_reserved(port(path))) << path;
    port_info held = port(path);
    held.holder = "agetty (812)";
    EXPECT_TRUE(is_reserved(held)) << path;
  }
}

}  // namespace
}  // namespace g4lidar::test
