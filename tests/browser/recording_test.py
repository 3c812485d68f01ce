# SPDX-License-Identifier: MIT
"""A recording: time line, pause, speed."""
import math
import os
import pathlib
import subprocess
import time
import unittest

from harness import WORLDS, PageTest, Select, scratch, until

LENGTH_S = 24


def way_m(seconds):
    """How far the robot of flat.txt has driven: it accelerates by 1 m/s2 to 0.7 m/s."""
    return seconds**2 / 2 if seconds < 0.7 else 0.245 + 0.7 * (seconds - 0.7)


class RecordingTest(PageTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        raw, cls.recording = (pathlib.Path(scratch.name) / f"drive.{kind}" for kind in ("bin", "mcap"))
        tool = os.environ["G4_DUMP"]
        subprocess.run([tool, "sim", "--seconds", str(LENGTH_S), "--world", WORLDS / "flat.txt", "-o", raw], check=True)
        subprocess.run([tool, "convert", "-q", raw, cls.recording], check=True)

    def setUp(self):
        self.page = self.open(self.serve(self.recording))
        until(lambda: self.page.read("scan"), "scans")

    def seek(self, seconds):
        self.driver.execute_script(
            """const slider = document.getElementById('position'); slider.value = arguments[0];
               slider.dispatchEvent(new Event('input')); slider.dispatchEvent(new Event('change'));""", seconds)
        until(lambda: abs(self.position_s() - seconds) < 2, f"the recording is at {seconds} s")

    def position_s(self):
        """Infinite while the recording is opened again for a seek."""
        return self.page.read("status?.position_s ?? 1e9")

    def behind(self):
        """The range of the western wall, straight behind the robot."""
        ranges = [math.hypot(x, y) for x, y in self.page.scan() if abs(math.atan2(y, -x)) < math.radians(2)]
        return min(ranges, default=0)

    def test_time_line(self):
        self.assertAlmostEqual(self.page.read("hello.recording.length_s"), LENGTH_S, delta=1)
        for seconds in (6, 2, 7):
            self.seek(seconds)
            # A scan follows within the time of two revolutions.
            until(lambda: abs(self.behind() - 2.8 - way_m(self.position_s())) < 0.6,
                  f"the wall is where it was at {seconds} s")
            self.assertRegex(self.page.text("position_text"), r"^0:\d\d\.\d / 0:2[345]\.\d$")

    def test_pause_and_speed(self):
        self.seek(1)
        self.page.keys("p")
        until(lambda: self.page.text("pause") == "Continue" and self.page.state() == "paused", "paused")
        until(self.stands, "the recording stands")
        self.assertEqual((self.page.text("pause"), self.page.text("state")), ("Continue", "Paused"))
        self.assertFalse(self.page.element("banner").is_displayed())
        self.page.element("pause").click()
        until(lambda: self.page.text("pause") == "Pause" and self.page.text("state") == "Running", "it runs")
        shown = self.page.read("scan.stamp")
        until(lambda: self.page.read("scan.stamp") != shown, "the recording continues")
        Select(self.page.element("speed")).select_by_value("4")
        self.seek(1)
        begin_s, begin = self.position_s(), time.monotonic()
        until(lambda: self.position_s() > begin_s + 8, "the recording plays")
        took = time.monotonic() - begin  # 2 s and two statuses; more if the machine stops
        self.assertGreater((self.position_s() - begin_s) / took, 8 / 6)

    def stands(self):
        first = self.page.read("scan.stamp")
        later = self.position_s()
        self.driver.execute_async_script("setTimeout(arguments[0], 1200)")
        return first == self.page.read("scan.stamp") and later == self.position_s()


if __name__ == "__main__":
    unittest.main()
