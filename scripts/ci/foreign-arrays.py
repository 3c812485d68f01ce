# SPDX-License-Identifier: MIT
"""Compares the files of all points, read by NumPy and plyfile, with the csv of the same points, number by number.

foreign-arrays.py PREFIX: PREFIX.csv, PREFIX.npy, PREFIX.npz, PREFIX.ply and PREFIX.xyz.
"""

import csv
import sys

import numpy
from plyfile import PlyData

prefix = sys.argv[1]
with open(prefix + ".csv", newline="") as file:
    rows = list(csv.DictReader(file))
assert rows, "the csv has no points"
expected = {
    "angle_deg": numpy.array([float(row["angle_deg"]) for row in rows]),
    "range_mm": numpy.array([float(row["range_mm"]) for row in rows]),
    "time_ns": numpy.array([int(row["time_ns"]) for row in rows]),
    "revolution": numpy.array([int(row["scan"]) for row in rows]),
}


def compare(name, fields, chosen):
    for field, values in fields.items():
        wanted = expected[field][chosen]
        assert len(values) == len(wanted), (name, field, len(values), len(wanted))
        tolerance = {"angle_deg": 2e-5, "range_mm": 5e-3}.get(field, 0)  # the csv rounds, float32 rounds
        worst = numpy.max(numpy.abs(values.astype(wanted.dtype) - wanted), initial=0)
        assert worst <= tolerance, (name, field, worst)


everything = numpy.ones(len(rows), dtype=bool)
returns = expected["range_mm"] > 0
npy = numpy.load(prefix + ".npy", allow_pickle=False)
compare("npy", {field: npy[field] for field in expected}, everything)
assert numpy.array_equal(npy["flags"] & 1 == 0, returns), "the flag no_return"
with numpy.load(prefix + ".npz", allow_pickle=False) as archive:
    assert archive.files == ["points"], archive.files
    assert numpy.array_equal(archive["points"], npy), "npz and npy differ"

ply = PlyData.read(prefix + ".ply")["vertex"]
compare("ply", {"angle_deg": ply["angle_deg"], "range_mm": ply["range_m"] * 1000.0, "revolution": ply["revolution"]},
        returns)
assert numpy.max(numpy.abs(ply["time_s"] - expected["time_ns"][returns] * 1e-9)) < 1e-6
bearing = numpy.radians(expected["angle_deg"][returns])
range_m = expected["range_mm"][returns] / 1000.0
places = numpy.stack([range_m * numpy.cos(bearing), range_m * numpy.sin(bearing), 0 * range_m], axis=1)
for name, read in (("ply", numpy.stack([ply["x"], ply["y"], ply["z"]], axis=1)), ("xyz", numpy.loadtxt(prefix + ".xyz"))):
    worst = numpy.max(numpy.abs(read - places))
    assert worst < 2e-5, (name, worst)
print(f"{len(rows)} points read by NumPy {numpy.__version__} (npy, npz) and plyfile: the same numbers as in the csv")
