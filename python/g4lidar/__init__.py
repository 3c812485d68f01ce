# SPDX-License-Identifier: MIT
"""SDK for the YDLIDAR G4 and its family: revolutions of corrected points as NumPy arrays.

    import g4lidar

    with g4lidar.open("") as lidar:  # the only lidar; or a path, "sim:", a recording
        lidar.start(frequency_hz=10)
        for scan in lidar.scans(timeout=0.5):
            print(len(scan), scan.points["range_mm"].max(), scan.xy().shape)

Units are in the names, else they are metres, seconds and radians. Times are those of the monotonic clock in
nanoseconds. Errors are classes of g4lidar.errors, all of them below Error.
"""
import atexit as _atexit
import enum as _enum

from ._g4lidar import (
    POINT_DTYPE,
    POSE_DTYPE,
    BackgroundReader,
    Decoder,
    DeviceInformation,
    Diagnosis,
    Event,
    FoundLidar,
    Lidar,
    Mounting,
    Player,
    Port,
    RecordedItem,
    Recording,
    RecordingWriter,
    Scan,
    ScanShaper,
    Scans,
    Simulator,
    StageReport,
    Twist,
    TwistEstimate,
    TwistEstimator,
    _close_all,
    _version,
    decode,
    deskew,
    doctor,
    fill_grid,
    find_lidars,
    list_ports,
    mark_bit_errors,
    mark_isolated,
    mark_veiling,
    merge_scans,
    open,
    to_xy,
)
from . import errors
from .errors import Error

__all__ = [
    "POINT_DTYPE", "POSE_DTYPE", "BackgroundReader", "Decoder", "DeviceInformation", "Diagnosis", "Error", "Event",
    "FoundLidar", "Lidar", "Mounting", "Player", "PointFlag", "Port", "RecordedItem", "Recording", "RecordingWriter",
    "Scan", "ScanFlag", "ScanShaper", "Scans", "Simulator", "StageReport", "Twist", "TwistEstimate", "TwistEstimator",
    "decode", "deskew", "doctor", "errors", "fill_grid", "find_lidars", "list_ports", "mark_bit_errors",
    "mark_isolated", "mark_veiling", "merge_scans", "open", "to_xy",
]

__version__ = _version

# A program that ends without close() leaves no motor running.
_atexit.register(_close_all)


class PointFlag(_enum.IntFlag):
    """Properties of a point, the bits of `flags` in POINT_DTYPE."""

    NO_RETURN = 1  # nothing came back: range_mm is 0 and not a range, and the way not free
    TOO_NEAR = 2  # below 100 mm, where ranges are not reliable
    REVOLUTION_START = 4  # the first sample of its revolution
    NOT_DESKEWED = 8  # its motion is not known
    UNLIKELY = 16  # its packet or its neighbours contradict it
    ISOLATED = 32  # set by mark_isolated()
    VEILING = 64  # set by mark_veiling()
    MAY_BE_TOO_NEAR = 128  # without return, perhaps of something too near; set by ScanShaper


class ScanFlag(_enum.IntFlag):
    """Why a scan is not one whole revolution, the bits of Scan.flags."""

    START_MISSING = 1  # begins within a revolution
    END_MISSING = 2  # ends within a revolution
    DATA_LOST = 4  # bytes were lost between its points
    TURN_SHORT = 8  # the zero packet at its end came well before a full turn
    START_BY_ANGLE = 16  # its zero packet was lost
    END_BY_ANGLE = 32  # the next zero packet was lost
    CRC_MISMATCH = 64  # a packet was lost, by the CRC byte of devices that send one
