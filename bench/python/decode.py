# SPDX-License-Identifier: MIT
"""The same as decode.cpp, in Python: decode.py FILE REPETITIONS"""
import sys
import time

import numpy as np

import g4lidar

data = open(sys.argv[1], "rb").read()
repetitions = int(sys.argv[2])
out = np.zeros(len(data) // 2 + 165, g4lidar.POINT_DTYPE)
points = len(g4lidar.Decoder().decode(data, out))
begin = time.process_time()
for _ in range(repetitions):
    g4lidar.Decoder().decode(data, out)
print(f"reused {points * repetitions / (time.process_time() - begin):.0f}")
begin = time.process_time()
for _ in range(repetitions):
    g4lidar.decode(data)
print(f"new {points * repetitions / (time.process_time() - begin):.0f}")
