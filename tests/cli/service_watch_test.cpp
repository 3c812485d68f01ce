// SPDX-License-Identifier: MIT
// What a service reports to its manager; the test receives it in the role of systemd.
#include "io/service_watch.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "manager.hpp"
#include "program.hpp"

namespace {

using cli::manager;
using g4_tool::service_watch;
constexpr std::int64_t second_ns = 1'000'000'000;

using words = std::vector<std::string>;

class ServiceWatch : public cli::scratch {};

TEST_F(ServiceWatch, EachWordIsSentOnce) {
  const manager systemd(path("notify"));
  service_watch watch;
  EXPECT_TRUE(watch.has_manager());
  EXPECT_EQ(systemd.heard(), words{});
  watch.ready();
  watch.ready();
  EXPECT_EQ(systemd.heard(), words{"READY=1"});
  watch.status("7.00 Hz");
  watch.status("7.00 Hz");
  watch.status("6.98 Hz,\n1 packet lost");
  EXPECT_EQ(systemd.heard(), (words{"STATUS=7.00 Hz", "STATUS=6.98 Hz, 1 packet lost"}));
  watch.stopping();
  watch.stopping();
  EXPECT_EQ(systemd.heard(), words{"STOPPING=1"});
}

TEST_F(ServiceWatch, AbstractName_IsAccepted) {
  const manager systemd("@g4lidar-test-" + std::to_string(::getpid()));
  service_watch watch;
  watch.ready();
  EXPECT_EQ(systemd.heard(), words{"READY=1"});
}

TEST_F(ServiceWatch, Watchdog_IsNotifiedAtHalfItsTime) {
  const manager systemd(path("notify"));
  ::setenv("WATCHDOG_USEC", "10000000", 1);
  ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  service_watch watch;
  std::size_t heard = 0;
  for (std::int64_t now_ns = 100 * second_ns; now_ns <= 120 * second_ns;
       now_ns += second_ns / 100) {
    watch.alive(now_ns);
    heard += systemd.heard().size();
  }
  EXPECT_EQ(heard, 5U) << "at 0, 5, 10, 15 and 20 seconds";
  watch.alive(125 * second_ns - 1);
  EXPECT_EQ(systemd.heard(), words{});
  watch.alive(125 * second_ns);
  EXPECT_EQ(systemd.heard(), words{"WATCHDOG=1"});
}

TEST_F(ServiceWatch, DefaultTime_IsThatOfTheSystem) {
  const manager systemd(path("notify"));
  ::setenv("WATCHDOG_USEC", "3600000000", 1);
  service_watch watch;
  watch.alive();
  watch.alive();
  EXPECT_EQ(systemd.heard(), words{"WATCHDOG=1"});
}

TEST_F(ServiceWatch, NoWatchdogForThisProcess_NothingIsSent) {
  const manager systemd(path("notify"));
  const auto silent = [&] {
    service_watch watch;
    watch.alive(second_ns);
    watch.alive();
    return systemd.heard().empty();
  };
  EXPECT_TRUE(silent());
  for (const char* const nonsense : {"", "0", "-5", "10s", "99999999999999999999"}) {
    ::setenv("WATCHDOG_USEC", nonsense, 1);
    EXPECT_TRUE(silent()) << nonsense;
  }
  ::setenv("WATCHDOG_USEC", "1000000", 1);
  EXPECT_FALSE(silent());
  ::setenv("WATCHDOG_PID", "1", 1);
  EXPECT_TRUE(silent()) << "it is another process that is watched";
}

TEST_F(ServiceWatch, FullSocket_DoesNotBlockAndLostTextIsSentAgain) {
  const manager systemd(path("notify"));
  ::setenv("WATCHDOG_USEC", "2", 1);
  service_watch watch;
  std::int64_t now_ns = 0;
  for (int i = 0; i < 10'000; ++i) watch.alive(now_ns += 1000);  // more than a socket holds
  watch.status("reported late");
  const std::size_t held = systemd.heard().size();
  EXPECT_GT(held, 0U);
  EXPECT_LT(held, 10'000U);
  watch.status("reported late");
  watch.alive(now_ns);
  EXPECT_EQ(systemd.heard(), (words{"STATUS=reported late", "WATCHDOG=1"}));
}

TEST_F(ServiceWatch, MissingManager_IsIgnored) {
  const auto sends_nothing = [] {
    service_watch watch;
    watch.ready();
    watch.alive(second_ns);
    watch.status("fine");
    watch.stopping();
    return !watch.has_manager();
  };
  ::unsetenv("NOTIFY_SOCKET");
  ::setenv("WATCHDOG_USEC", "1000000", 1);
  EXPECT_TRUE(sends_nothing());
  for (const std::string& name : {std::string(), std::string("@"), std::string("vsock:2:1"),
                                  path("none"), "/" + std::string(200, 'x')}) {
    ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
    EXPECT_TRUE(sends_nothing()) << name;
  }
  ::unsetenv("NOTIFY_SOCKET");
  ::unsetenv("WATCHDOG_USEC");
  {
    auto systemd = std::make_unique<manager>(path("notify"));
    service_watch watch;
    systemd.reset();  // it may have been restarted
    watch.ready();
    watch.status("fine");
  }
}

}  // namespace
