# SPDX-License-Identifier: MIT
"""Scans in Rerun (pip install rerun-sdk): python rerun_points.py [DEVICE [FILE]]

Opens the viewer, or writes FILE, which `rerun FILE` opens.
"""
import sys

import rerun as rr

import g4lidar


def main(device: str = "", file: str = "", *, scans: int | None = None) -> None:
    rr.init("g4lidar", spawn=not file)
    if file:
        rr.save(file)
    returns = g4lidar.ScanShaper(returns_only=True)
    with g4lidar.open(device) as lidar:
        lidar.start()
        for number, scan in enumerate(lidar.scans(), 1):
            rr.set_time("measured", timestamp=scan.stamp)
            places = g4lidar.to_xy(returns.shape(scan).kept, turn_deg=scan.turn_deg)
            rr.log("lidar/points", rr.Points2D(places, radii=0.01))
            rr.log("lidar/frequency_hz", rr.Scalars(scan.measured_frequency_hz))
            if number == scans:
                return


if __name__ == "__main__":
    main(*sys.argv[1:3])
