# SPDX-License-Identifier: MIT
"""A live polar plot: python -m g4lidar.view [DEVICE]. Needs matplotlib: pip install g4lidar[view]"""
import argparse

import numpy as np

import g4lidar


def main(device: str = "", *, frames: int | None = None) -> None:
    """Draws until the window is closed, or so many scans. Angle 0 is up, as seen from above."""
    import matplotlib.pyplot as plt

    axes = plt.figure("g4lidar").add_subplot(projection="polar", theta_offset=np.pi / 2, theta_direction=-1)
    (dots,) = axes.plot([], [], ".", markersize=2)
    with g4lidar.open(device) as lidar:
        lidar.start()
        for number, scan in enumerate(lidar.scans(newest=True), 1):
            points = scan.points[scan.points["range_mm"] > 0]
            dots.set_data(np.radians(points["angle_deg"]), points["range_mm"] / 1000)
            axes.set_ylim(0, max(1.0, points["range_mm"].max(initial=0) / 1000))
            plt.pause(0.01)
            if not plt.fignum_exists("g4lidar") or number == frames:
                return


if __name__ == "__main__":
    words = argparse.ArgumentParser("python -m g4lidar.view", description="A live polar plot of a lidar.")
    words.add_argument("device", nargs="?", default="", help="as in g4lidar.open(): a port, sim:, ... (the only lidar)")
    main(words.parse_args().device)
