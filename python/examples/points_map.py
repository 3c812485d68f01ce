# SPDX-License-Identifier: MIT
"""A map of a robot that drives: the points of all scans, moved by the twist that the scans themselves give.

    python points_map.py [DEVICE [PICTURE]]     python points_map.py sim: map.png
"""
import math
import sys

import matplotlib
import numpy as np

import g4lidar

matplotlib.use("Agg")  # draws into a file
import matplotlib.pyplot as plt  # noqa: E402


def main(device: str = "", picture: str = "map.png", *, seconds: float = 3.0) -> None:
    estimator = g4lidar.TwistEstimator()
    x = y = yaw = 0.0  # of the lidar, in the frame of its first scan
    last_ns = 0
    returns = g4lidar.ScanShaper(returns_only=True)
    figure = plt.figure(figsize=(8, 8))
    axes = figure.add_subplot(aspect="equal", xlabel="x in m", ylabel="y in m")
    with g4lidar.open(device) as lidar:
        lidar.start()
        for scan in lidar.scans():
            twist = estimator.add(scan.points, scan.turn_deg).twist
            elapsed = (scan.time_ns - last_ns) * 1e-9 if last_ns else 0.0
            x += (twist.x_m_per_s * math.cos(yaw) - twist.y_m_per_s * math.sin(yaw)) * elapsed
            y += (twist.x_m_per_s * math.sin(yaw) + twist.y_m_per_s * math.cos(yaw)) * elapsed
            yaw += twist.yaw_rad_per_s * elapsed
            still, _ = g4lidar.deskew(scan.points, twist, scan.time_ns, turn_deg=scan.turn_deg)
            points = g4lidar.to_xy(returns.shape(still).kept, turn_deg=scan.turn_deg)
            turn = np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]])
            places = points @ turn + (x, y)
            axes.plot(places[:, 0], places[:, 1], "k.", markersize=0.5)
            seconds -= elapsed
            last_ns = scan.time_ns
            if seconds <= 0:
                break
    figure.savefig(picture)
    print(f"{picture}: the lidar is now at {x:.2f} m, {y:.2f} m, {math.degrees(yaw):.0f} degrees")


if __name__ == "__main__":
    main(*sys.argv[1:3])
