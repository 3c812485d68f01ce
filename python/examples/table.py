# SPDX-License-Identifier: MIT
"""Points as a table of pandas: python table.py [DEVICE]"""
import sys

import numpy as np
import pandas as pd

import g4lidar


def main(device: str = "", *, scans: int = 5) -> None:
    with g4lidar.open(device) as lidar:
        lidar.start()
        taken = [scan.points for scan, _ in zip(lidar.scans(), range(scans), strict=False)]
    table = pd.DataFrame(np.concatenate(taken))
    returns = table[table["range_mm"] > 0]
    print(returns.groupby("revolution")["range_mm"].describe()[["count", "min", "50%", "max"]])


if __name__ == "__main__":
    main(*sys.argv[1:2])
