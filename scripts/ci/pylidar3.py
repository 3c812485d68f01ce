# SPDX-License-Identifier: MIT
"""Two lidars at once through PyLidar3: pylidar3.py PATH_OF_THE_SMALL_ROOM PATH_OF_THE_LARGE_ROOM"""
import sys
import threading

import PyLidar3

# The serial number as PyLidar3 prints it, its first nine digits, and the ranges of a square room
# whose walls are 1 and 4 m away.
expected = {
    "small": ("111122223", 1000.0, 1415.0),
    "large": ("555566667", 4000.0, 5657.0),
}
faults = []


def need(condition, words):
    if not condition:
        raise AssertionError(words)


def use(room, path):
    serial, nearest, farthest = expected[room]
    lidar = PyLidar3.YdLidarG4(path)
    need(lidar.Connect(), "it does not connect")
    info = lidar.GetDeviceInfo()
    need(info["model_number"] == "5", f"model {info}")
    need(info["firmware_version"] == "3.2", f"firmware {info}")
    need(info["serial_number"] == serial, f"serial number {info}")
    need(lidar.GetCurrentFrequency() == 7.0, "another frequency than 7 Hz")
    need(lidar.GetCurrentRangingFrequency() == 9, "another sample rate than 9 kHz")
    scans = lidar.StartScanning()
    ranges = []
    for _ in range(6):
        ranges += [r for r in next(scans).values() if r > 0]
    lidar.StopScanning()
    lidar.Disconnect()
    # PyLidar3 averages and rounds the samples of a degree; at the end of a packet it is less exact.
    need(len(ranges) > 6 * 300, f"only {len(ranges)} directions with a range")
    need(min(ranges) > nearest - 60, f"{room}: {min(ranges)} mm is too near")
    need(max(ranges) < farthest + 60, f"{room}: {max(ranges)} mm is too far")
    print(f"{room}: serial {info['serial_number']}..., {len(ranges)} directions,"
          f" {min(ranges)} to {max(ranges)} mm")


def guarded(room, path):
    try:
        use(room, path)
    except Exception as fault:  # an exception in a thread must be reported
        faults.append(f"{room}: {fault!r}")


threads = [threading.Thread(target=guarded, args=pair) for pair in zip(expected, sys.argv[1:3])]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
for fault in faults:
    print(fault, file=sys.stderr)
sys.exit(bool(faults) or len(threads) != 2)
