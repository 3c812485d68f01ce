# SPDX-License-Identifier: MIT
"""A robot that drives: the map, trails and the way; the nearest obstacle; recording; the saved picture."""
import glob
import json
import math
import os
import pathlib
import struct
import subprocess
import unittest

from geometry import World
from harness import WORLDS, PageTest, scratch, until

flat = World(WORLDS / "flat.txt")


class MovingTest(PageTest):
    """The robot of flat.txt drives 6 m ahead. Its map begins where it begins, as the distances of World do."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.directory = pathlib.Path(scratch.name) / "recordings"
        cls.directory.mkdir()
        cls.downloads = pathlib.Path(scratch.name) / "downloads"

    def setUp(self):
        self.page = self.open(self.serve(f"sim:?world={WORLDS / 'flat.txt'}", "--allow-record", self.directory)).runs()

    def errors(self):
        """How far the points of all scans that are shown are from the walls, sorted."""
        all_errors = []
        for scan in self.page.read("shown"):
            flat_points = scan["points"][:2000]
            all_errors += [flat.distance(x, y) for x, y in zip(flat_points[::20], flat_points[1::20])]
        return sorted(all_errors)

    def test_trails_stay_where_the_walls_are(self):
        self.page.keys("t", "m")
        until(lambda: self.page.read("is_map"), "the map")
        until(lambda: self.page.read("robot.x") > 1.5 and self.page.read("scan.trails") > 8, "the robot drives")
        until(lambda: self.page.text("frame") == "map", "the name of the frame")
        errors = self.errors()
        self.assertGreater(len(errors), 300)
        self.assertLess(errors[len(errors) * 98 // 100], 0.03)
        way = self.page.read("way")
        self.assertGreater(len(way), 15)
        self.assertLess(max(abs(place["y"]) for place in way), 0.01)
        # In the robot's frame trails are at the same walls, seen from the robot.
        self.page.keys("f", "m")
        until(lambda: not self.page.read("is_map"), "the robot's frame")
        self.assertEqual(self.page.read("robot"), {"x": 0, "y": 0, "yaw": 0})
        pose = self.page.read("scan.pose")
        errors = []
        for scan in self.page.read("shown"):
            for x, y in list(zip(scan["points"][::2], scan["points"][1::2]))[::20]:
                at = (pose["x"] + math.cos(pose["yaw"]) * x - math.sin(pose["yaw"]) * y,
                      pose["y"] + math.sin(pose["yaw"]) * x + math.cos(pose["yaw"]) * y)
                errors.append(flat.distance(*at))
        errors.sort()
        self.assertLess(errors[len(errors) * 98 // 100], 0.03)

    def test_nearest_obstacle(self):
        self.page.keys("f")
        found = self.page.read("nearest")
        points = self.page.scan()
        nearest = min(points, key=lambda place: math.hypot(*place))
        self.assertAlmostEqual(found["distance_m"], math.hypot(*nearest), places=5)
        self.assertAlmostEqual(found["bearing_deg"], math.degrees(math.atan2(nearest[1], nearest[0])), places=3)
        self.assertIn(f"{found['distance_m']:.3f} m, bearing", self.page.text("nearest"))

    def test_recording(self):
        self.assertEqual(self.page.text("record_text"), "Not recording")
        before = set(self.directory.iterdir())
        self.page.element("record").click()
        until(lambda: self.page.text("record_text").startswith("Recording g4-"), "it records")
        self.assertEqual(self.page.element("record").get_attribute("aria-pressed"), "true")
        name = self.page.read("status.recording.file")
        self.assertIn(name, self.page.text("record_text"))
        scans = self.page.read("received.scans")
        until(lambda: self.page.read("received.scans") > scans + 8, "scans")
        self.page.element("record").click()
        until(lambda: self.page.text("record_text").startswith(f"Recorded {name}"), "it has ended")
        self.assertEqual([each.name for each in set(self.directory.iterdir()) - before], [name])
        counts = subprocess.run([os.environ["G4_DUMP"], "stats", "--json", self.directory / name], check=True,
                                capture_output=True).stdout
        self.assertGreater(json.loads(counts)["scans"], 6)

    def test_saved_picture(self):
        self.driver.execute_cdp_cmd("Browser.setDownloadBehavior",
                                    {"behavior": "allow", "downloadPath": str(self.downloads)})
        self.page.keys("f", "s")
        files = until(lambda: glob.glob(f"{self.downloads}/g4-*.png"), "a file")
        data = until(lambda: pathlib.Path(files[0]).read_bytes(), "its contents")
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        size = self.driver.execute_script("const c = document.getElementById('points'); return [c.width, c.height]")
        self.assertEqual(list(struct.unpack(">II", data[16:24])), size)
        self.assertGreater(len(data), 5000)


class StandingTest(PageTest):
    def test_without_a_known_motion_there_is_no_map(self):
        still = pathlib.Path(scratch.name) / "still.txt"
        still.write_text("wall -2 -2 2 -2\nwall 2 -2 2 2\nwall 2 2 -2 2\nwall -2 2 -2 -2\nlidar 0 0 0\n", encoding="utf-8")
        page = self.open(self.serve(f"sim:?world={still}")).runs()
        self.assertFalse(page.element("map").is_enabled())
        self.assertFalse(page.element("recorder").is_displayed())
        page.keys("m")
        self.assertFalse(page.read("is_map"))
        self.assertIsNone(page.read("scan.pose"))


if __name__ == "__main__":
    unittest.main()
