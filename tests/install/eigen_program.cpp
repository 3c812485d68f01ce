// SPDX-License-Identifier: MIT
// A consumer of g4lidar::eigen. Exit code 0 if the header and Eigen are there.
#include "g4lidar/eigen.hpp"

int main() { return Eigen::Vector2f(3.0F, 4.0F).norm() == 5.0F ? 0 : 1; }
