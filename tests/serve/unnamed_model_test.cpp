// SPDX-License-Identifier: MIT
// g4-serve at ports of lidars of each kind, when nobody names the model.
#include "server.hpp"
#include "simulator.hpp"

namespace serve {
namespace {

class UnnamedModel : public Server, public testing::WithParamInterface<std::string> {};

TEST_P(UnnamedModel, ScansAreShown) {
  std::vector<std::string> options{"--model", GetParam()};
  if (GetParam() == "g2") options.insert(options.end(), {"--fault", "scanning"});  // left so
  const cli::simulator lidar(path("lidar"), options);
  begin({}, path("lidar"));
  const auto page_of_it = open_page();
  EXPECT_TRUE(gets_scans(*page_of_it));
  end();
}

INSTANTIATE_TEST_SUITE_P(Models, UnnamedModel,
                         testing::Values("x4", "x2", "t-mini-pro", "tg15", "g2"),
                         [](const auto& of) {
                           std::string name = of.param;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace serve
