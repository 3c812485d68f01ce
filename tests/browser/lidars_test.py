# SPDX-License-Identifier: MIT
"""Several lidars in colours of their own, and lidars of other models than the G4."""
import itertools
import json
import math
import pathlib
import unittest

from colours import DEFICIENCIES, contrast, difference
from harness import By, PageTest, Select, scratch, standing, until

ROOM = "wall -2 -1.5 3 -1.5\nwall 3 -1.5 3 1.2\nwall 3 1.2 -2 1.2\nwall -2 1.2 -2 -1.5\n"


def to_wall(x, y):
    """The distance from the walls of ROOM."""
    return min(abs(x + 2), abs(x - 3), abs(y + 1.5), abs(y - 1.2))


def lidar_in_room(name, place, more=""):
    """A simulated lidar; the direction in `place` is that of its cable, opposite to that of its mounting."""
    world = pathlib.Path(scratch.name) / f"{name}.txt"
    world.write_text(f"{ROOM}lidar {place}\n", encoding="utf-8")
    return f"{name}=sim:?world={world}{more}"


class MergedTest(PageTest):
    def setUp(self):
        self.page = self.open(self.serve(
            lidar_in_room("front", "0.3 0.1 -160"), lidar_in_room("rear", "-0.4 -0.2 30", "&model=t-mini"), "--merge",
            "--mount", "front=0.3,0.1,20", "--mount", "rear=-0.4,-0.2,-150", "--allow-set")).runs()
        until(lambda: set(self.page.read("scan.lidars") or []) == {0, 1}, "points of both lidars")
        until(lambda: self.page.read("colour.ways") == ["lidar", "range", "intensity"], "the models are known")

    def colours(self):
        """Of the legend."""
        return self.driver.execute_script(
            """return Object.fromEntries([...document.querySelectorAll('#lidars li')].map((row) =>
                 [row.textContent, getComputedStyle(row.querySelector('.square')).backgroundColor
                   .match(/[0-9]+/g).slice(0, 3).map(Number)]));""")

    def pixels(self, places):
        """The colours of the picture at these places."""
        return self.driver.execute_script(
            """const canvas = document.getElementById('points'), context = canvas.getContext('2d');
               const ratio = canvas.width / window.g4lidar.view.width;
               return arguments[0].map((place) => {
                 const [column, row] = window.g4lidar.pixel(...place).map((each) => Math.round(each * ratio));
                 return [...context.getImageData(column, row, 1, 1).data.slice(0, 3)]; });""", places)

    def frozen(self):
        """The points of each lidar, while the picture stands."""
        self.driver.execute_script("""const slider = document.getElementById('trails'); slider.value = 0;
                                      slider.dispatchEvent(new Event('input'));""")
        self.page.keys("f")
        until(lambda: self.page.read("scan.trails") == 0, "no trails")
        drawn = self.page.read("frames.count")
        until(lambda: self.page.read("frames.count") > drawn + 1, "the picture is drawn")
        points, lidars = self.page.scan(), self.page.read("scan.lidars")
        self.assertEqual(len(points), len(lidars))
        return [[point for point, lidar in zip(points, lidars) if lidar == which] for which in (0, 1)]

    def test_each_lidar_has_its_colour(self):
        self.assertEqual(self.page.read("colour.way"), "lidar")
        of_front, of_rear = self.frozen()
        self.assertGreater(len(of_front), 500)
        self.assertGreater(len(of_rear), 300)
        for x, y in of_front + of_rear:
            self.assertLess(to_wall(x, y), 0.06)
        legend = self.colours()
        self.assertEqual(list(legend), ["front", "rear"])
        for name, points, others in (("front", of_front, of_rear), ("rear", of_rear, of_front)):
            # Those that are farthest from the points of the other lidar, which are drawn over them.
            alone = sorted(points, key=lambda point: min(math.dist(point, other) for other in others))[-30:]
            seen = self.pixels(alone)
            right = sum(math.dist(colour, legend[name]) < 6 for colour in seen)
            self.assertGreater(right, 15, (name, legend, seen))

    def test_colours_by_range_and_intensity(self):
        self.assertFalse(self.page.element("scale").is_displayed())
        self.page.keys("c")
        self.assertEqual(self.page.read("colour.way"), "range")
        self.assertTrue(self.page.element("scale").is_displayed())
        self.assertFalse(self.page.element("lidars").is_displayed())
        Select(self.page.element("colour_by")).select_by_value("intensity")
        self.assertEqual(self.page.read("colour.way"), "intensity")

    def test_colours_differ_for_every_colour_vision(self):
        self.addCleanup(self.driver.execute_cdp_cmd, "Emulation.setEmulatedMedia", {"features": []})
        for scheme, background in (("light", (255, 255, 255)), ("dark", (16, 22, 28))):
            self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
                "features": [{"name": "prefers-color-scheme", "value": scheme}]})
            colours = self.driver.execute_async_script(
                """const done = arguments[1];
                   import(`${location.origin}/colours.js`).then((all) => done(all[arguments[0]]))""",
                f"lidars_on_{scheme}")
            self.assertEqual(len(colours), 5)
            until(lambda: list(self.colours().values()) == colours[:2], "the legend has them")
            for one, other in itertools.combinations(colours, 2):
                for deficiency in DEFICIENCIES:
                    least = 40 if one in colours[:3] and other in colours[:3] else 15
                    self.assertGreater(difference(one, other, deficiency), least, (scheme, deficiency, one, other))
            for colour in colours:
                self.assertGreater(contrast(colour, background), 3, (scheme, colour))

    def test_settings_of_each(self):
        fields = [each.get_attribute("name") for each in self.driver.find_elements(By.CSS_SELECTOR, "#settings [name]")]
        self.assertIn("front.direction", fields)
        self.assertIn("rear.frequency", fields)
        self.assertNotIn("rear.direction", fields)
        field = self.driver.find_element(By.NAME, "front.sample_rate")
        until(lambda: field.get_attribute("value") == "9000", "the setting is known")
        Select(field).select_by_value("4000")
        until(lambda: (self.page.read("status.lidars")[0]["sample_rate_hz"] or 9000) < 5000, "4,000 samples per second")
        until(lambda: (self.page.read("status.lidars")[1]["scan_rate_hz"] or 0) > 4, "the other one goes on")

    def test_the_doctor_names_the_lidar(self):
        until(lambda: "front: Rate" in self.page.text("stages") and "rear: Rate" in self.page.text("stages"),
              "the stages of both")


class WithoutOneTest(PageTest):
    def test_a_lidar_that_is_lost_is_named(self):
        page = self.open(self.serve(
            lidar_in_room("front", "0.3 0.1 -160"), lidar_in_room("rear", "-0.4 -0.2 30", "&fault=unplug@5s"), "--merge",
            "--mount", "front=0.3,0.1,20", "--mount", "rear=-0.4,-0.2,-150")).runs()
        until(lambda: page.text("state") == "Running without rear", "the page names it")
        until(lambda: set(page.read("scan.lidars")) == {0}, "only points of the other one")
        self.assertIn("plug it in", until(lambda: page.text("advice"), "what to do"))
        self.assertIn("rear: ", page.text("advice"))


class ModelTest(PageTest):
    """By family.md: ranges, frequencies, what has intensities, and what takes commands."""

    def fields(self, page):
        until(lambda: page.read("hello.device.name"), "the model is known")
        return [each.get_attribute("name") for each in self.driver.find_elements(By.CSS_SELECTOR, "#settings [name]")]

    def labels(self):
        return [each.text for each in self.driver.find_elements(By.CSS_SELECTOR, "#colour_labels span")]

    def test_x2(self):
        page = self.open(self.serve(standing("flat.txt", "model=x2"), "--model", "x2", "--allow-set")).runs()
        self.assertEqual(self.fields(page), [])
        self.assertEqual(page.text("settings_note"), "None.")
        self.assertIn("X2", page.text("device"))
        self.assertEqual(self.labels(), ["0", "0.5", "2", "4.5", "8 m"])
        self.assertFalse(page.element("colour_label").is_displayed())

    def test_t_mini(self):
        page = self.open(self.serve(standing("flat.txt", "model=t-mini"), "--allow-set")).runs()
        fields = self.fields(page)
        self.assertIn("frequency", fields)
        for name in ("direction", "constant", "idle", "sample_rate"):
            self.assertNotIn(name, fields)
        frequency = self.driver.find_element(By.NAME, "frequency")
        self.assertEqual([float(frequency.get_attribute(each)) for each in ("min", "max")], [6, 12])
        self.assertEqual(self.labels()[-1], "12 m")
        self.assertEqual(page.read("colour.ways"), ["range", "intensity"])
        self.assertTrue(page.element("colour_label").is_displayed())
        page.keys("c")
        page.keys("f")
        strengths = page.read("scan.intensities")
        self.assertEqual(len(strengths), len(page.scan()))
        self.assertGreater(max(strengths), 0)
        self.assertLessEqual(max(strengths), round(page.read("colour.intensity")))
        self.assertEqual(self.labels()[-1], str(round(page.read("colour.intensity"))))

    def test_tg15(self):
        page = self.open(self.serve(standing("flat.txt", "model=tg15"), "--allow-set")).runs()
        fields = self.fields(page)
        for name in ("direction", "constant", "idle", "sample_rate"):
            self.assertNotIn(name, fields)
        frequency = self.driver.find_element(By.NAME, "frequency")
        self.assertEqual([float(frequency.get_attribute(each)) for each in ("min", "max")], [3, 16])
        self.assertEqual(self.labels()[-1], "30 m")
        self.assertEqual(page.read("colour.ways"), ["range"])
        self.assertIsNone(page.read("scan.intensities"))
        frequency.clear()
        frequency.send_keys("15\n")
        until(lambda: abs((page.read("status.frequency_hz") or 0) - 15) < 0.7, "15 Hz")


class RecognitionTest(PageTest):
    def numbers(self):
        return self.driver.execute_script("""return Object.fromEntries(
            [...document.querySelectorAll('#numbers dt')].map((name) => [name.textContent, name.nextSibling.textContent]));""")

    def test_what_contradicts_is_shown(self):
        page = self.open(self.serve("sim:?model=t-mini-plus&model_id=153")).runs()
        self.assertIn("153, which no known model has", until(lambda: page.text("advice"), "what contradicts"))
        self.assertIn("Model: Contradictions", page.text("stages"))
        self.assertEqual(page.text("verdict"), "warn")
        self.assertGreaterEqual(self.numbers().items(), {"Model": "t-mini-plus", "Number": "153"}.items())

    def test_directions_without_a_return_are_shown(self):
        world = pathlib.Path(scratch.name) / "nothing.txt"
        world.write_text("wall -900 900 900 900\nlidar 0 0 0\n", encoding="utf-8")
        page = self.open(self.serve(f"sim:?world={world}"))
        until(lambda: self.driver.find_elements(By.CSS_SELECTOR, "#advice [data-diagnosis=no_returns]"), "no returns")
        self.assertEqual(page.text("verdict"), "warn")
        world.write_text("wall 2 -1 2 1\nlidar 0 0 0\n", encoding="utf-8")
        page = self.open(self.serve(f"sim:?world={world}")).runs()
        until(lambda: "Nothing returned in" in page.text("stages"), "the sector")

    def test_those_that_send_the_same_are_shown(self):
        page = self.open(self.serve("front=sim:?model=x2", "rear=sim:", "--merge",
                                    "--mount", "front=0.3,0.1,20", "--mount", "rear=-0.4,-0.2,-150")).runs()
        until(lambda: "rear: Model" in self.numbers(), "the models of both")
        self.assertGreaterEqual(self.numbers().items(), {"front: Model": "x2", "rear: Model": "g4"}.items())
        self.assertEqual(page.text("advice"), "")


class DamagedMessageTest(PageTest):
    def test_what_is_not_a_revolution_is_left_out(self):
        page = self.open(self.serve(standing("flat.txt"))).runs()
        found = json.loads(self.driver.execute_async_script(
            """const done = arguments[0];
               import(`${location.origin}/message.js`).then(({ message_of }) => {
                 const made = (flags, count, rest) => {
                   const data = new DataView(new ArrayBuffer(16 + 8 * count + rest.length));
                   data.setUint8(0, 16); data.setUint8(1, flags); data.setUint16(2, count, true);
                   rest.forEach((each, i) => data.setUint8(16 + 8 * count + i, each));
                   return message_of(data.buffer) !== null;
                 };
                 done(JSON.stringify([
                   made(1, 2, []), made(4, 3, [2, 0, 1, 0, 2, 0]), made(8, 2, [1, 0, 2, 0]),
                   made(12, 1, [1, 0, 1, 0, 9, 9]), made(4, 0, [0, 0]),
                   made(1, 2, [0]), made(2, 1, [1, 2, 3]), made(4, 3, []), made(4, 3, [2]), made(4, 3, [2, 0, 1, 0]),
                   made(4, 3, [2, 0, 1, 0, 1, 0]), made(4, 3, [2, 0, 255, 255, 2, 0]), made(4, 0, [255, 255]),
                   made(8, 2, [1, 0, 2]), message_of(new ArrayBuffer(3)) !== null,
                 ]));
               });"""))
        self.assertEqual(found, 5 * [True] + 10 * [False])
        self.assertEqual(page.state(), "running")


if __name__ == "__main__":
    unittest.main()
