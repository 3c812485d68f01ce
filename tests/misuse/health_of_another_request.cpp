// SPDX-License-Identifier: MIT
// Each request has the type of its answer: a request for the device information does not return a
// health.
// expect: conversion from .* to non-scalar type|could not convert|no viable conversion
#include "g4lidar/lidar.hpp"

bool misuse(g4lidar::lidar& lidar) {
#ifdef MISUSE
  const g4lidar::result<g4lidar::health> reply = lidar.ask(g4lidar::requests::device_info());
#else
  const g4lidar::result<g4lidar::health> reply = lidar.ask(g4lidar::requests::health());
#endif
  return reply.has_value();
}
