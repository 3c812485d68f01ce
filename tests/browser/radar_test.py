# SPDX-License-Identifier: MIT
"""The radar: points where the walls are, ruler, freeze, zoom and pan, trails, a phone."""
import math
import unittest

from selenium.webdriver.common.actions.wheel_input import ScrollOrigin

from geometry import World
from harness import WORLDS, Keys, PageTest, Server, bearing_deg, standing, until

flat = World(WORLDS / "flat.txt")
# Walls straight behind the robot, and straight to its right.
BEHIND = (-flat.range_at(math.pi), 0.0)
RIGHT = (0.0, -flat.range_at(-math.pi / 2))


class RadarTest(PageTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.server = Server(standing("flat.txt"))
        cls.addClassCleanup(cls.server.stop)

    def setUp(self):
        self.page = self.open(self.server).runs()

    def test_points_are_where_the_walls_are(self):
        points = self.page.whole_scan()
        self.assertGreater(len(points), 1000)
        self.assertLess(max(flat.distance(x, y) for x, y in points), 0.01)
        # The right wall, and not one that is mirrored or turned: by the ray at each bearing. Near edges
        # the curved beam of the lidar passes where a ray does not.
        near = [abs(math.hypot(x, y) - flat.range_at(math.atan2(y, x))) < 0.02 for x, y in points]
        self.assertGreater(sum(near) / len(near), 0.97)

    def test_pixels_are_where_the_walls_are(self):
        self.page.keys("0")
        self.trails(0)
        visible = [place for place in self.page.whole_scan()[::25] if math.hypot(*place) < 3]
        self.assertGreater(len(visible), 20)
        self.assertEqual(self.page.alpha(visible), [255] * len(visible))
        clear = [(x / 4, y / 4) for x in range(-8, 9) for y in range(-8, 9) if flat.distance(x / 4, y / 4) > 0.2]
        self.assertEqual(self.page.alpha(clear), [0] * len(clear))

    def test_x_is_up_and_y_is_left(self):
        origin, ahead, left = (self.page.read(f"pixel({x}, {y})") for x, y in ((0, 0), (1, 0), (0, 1)))
        self.assertEqual(ahead[0], origin[0])
        self.assertLess(ahead[1], origin[1])
        self.assertEqual(left[1], origin[1])
        self.assertLess(left[0], origin[0])
        self.assertIn("robot", self.page.text("orientation"))
        self.assertTrue(self.page.element("orientation").is_displayed())

    def texts(self):
        """Where the texts above the picture are: left, top, right, bottom."""
        return self.driver.execute_script(
            """const origin = document.getElementById('points').getBoundingClientRect();
               return ['pointer', 'measured', 'orientation', 'legend'].map((name) => {
                 const box = document.getElementById(name).getBoundingClientRect();
                 return [box.left - origin.left, box.top - origin.top, box.right - origin.left, box.bottom - origin.top];
               });""")

    def test_labels_of_rings_are_beside_the_texts(self):
        self.page.keys("r")
        actions = self.page.pointer()
        self.page.move_to(actions, 0.5, 0.5)
        actions.perform()
        until(lambda: self.page.text("pointer") and self.page.text("measured"), "the texts are shown")
        shown = 0
        for keys in ("0", "+", "+", "+", "0", *(Keys.ARROW_UP,) * 6, "0", *(Keys.ARROW_DOWN,) * 6, Keys.ARROW_LEFT):
            frames = self.page.read("frames.count")
            self.page.keys(keys)
            until(lambda: self.page.read("frames.count") > frames + 1, "the picture is drawn")
            for label in self.page.read("labels"):
                right, bottom = label["left"] + label["width"], label["top"] + label["height"]
                shown += 1
                for box in self.texts():
                    is_apart = right <= box[0] or label["left"] >= box[2] or bottom <= box[1] or label["top"] >= box[3]
                    self.assertTrue(is_apart, f"{label} and {box} after {keys!r}")
        self.assertGreater(shown, 30)

    def test_legend_and_name_are_explained(self):
        self.assertRegex(self.page.text("legend"), "(?s)Colour: range.*0.*16 m")
        self.assertRegex(self.page.text("device"), "^G4, firmware ")

    def test_ruler(self):
        self.page.whole_scan()
        self.page.keys("f", "r")
        for shift in (False, True):
            actions = self.page.pointer()
            if shift:
                actions.key_down(Keys.SHIFT)
            ends = []
            for place in (BEHIND, RIGHT):
                ends.append(self.page.move_to(actions, *place))
                actions.click()
            actions.key_up(Keys.SHIFT).perform()
            ruler = self.page.read("ruler")
            tolerance = 0.02 if not shift else 1e-6
            if not shift:  # a point of the scan was taken, and not the pixel beside the wall
                ends = [BEHIND, RIGHT]
                tolerance += 1 / self.page.read("view.scale")
                points = self.page.scan()
                for end in ("from", "to"):
                    self.assertLess(min(math.dist((ruler[end]["x"], ruler[end]["y"]), p) for p in points), 0.002)
            self.assertAlmostEqual(ruler["distance_m"], math.dist(*ends), delta=tolerance)
            bearing = bearing_deg(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1])
            self.assertAlmostEqual(ruler["bearing_deg"], bearing, delta=math.degrees(tolerance / 3))
            shown = f"{ruler['distance_m']:.3f} m, bearing \u2212{abs(ruler['bearing_deg']):.1f}\u00b0"
            until(lambda: self.page.text("measured") == shown, "the ruler's text")
        self.page.keys(Keys.ESCAPE)
        self.assertIsNone(self.page.read("ruler.from"))

    def test_ruler_by_keys(self):
        self.page.keys("r", Keys.ENTER, Keys.ENTER)
        view, scale = self.page.read("view"), self.page.read("view.scale")
        self.assertEqual(self.page.read("ruler.from"), {"x": view["x"], "y": view["y"]})
        self.page.keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ENTER)
        ruler = self.page.read("ruler")
        self.assertAlmostEqual(ruler["distance_m"], 2 * 60 / scale, places=6)
        self.assertAlmostEqual(ruler["bearing_deg"], -90, places=6)

    def test_freeze(self):
        self.page.keys(" ")
        self.assertTrue(self.page.read("frozen"))
        self.assertEqual(self.page.element("freeze").get_attribute("aria-pressed"), "true")
        shown, received = self.page.read("scan.revolution"), self.page.read("received.scans")
        until(lambda: self.page.read("received.scans") > received + 5, "scans arrive")
        self.assertEqual(self.page.read("scan.revolution"), shown)
        self.assertEqual((self.page.text("banner"), self.page.element("banner").is_displayed()), ("Frozen", True))
        self.page.element("freeze").click()
        until(lambda: self.page.read("scan.revolution") > shown, "the picture continues")

    def test_zoom_and_pan(self):
        before = self.page.read("view")
        place = (1.0, 0.5)
        pixel = self.page.pixel(*place)
        offset = [round(at - int(before[size] / 2)) for at, size in zip(pixel, ("width", "height"))]
        origin = ScrollOrigin.from_element(self.page.element("points"), *offset)
        self.page.pointer().scroll_from_origin(origin, 0, -100).perform()
        zoomed = until(lambda: self.page.read("view.scale") > before["scale"] and self.page.read("view"), "zoomed")
        self.assertAlmostEqual(zoomed["scale"] / before["scale"], 1.25)
        for was, now in zip(pixel, self.page.pixel(*place)):  # the place under the pointer has not moved
            self.assertAlmostEqual(was, now, delta=1)
        # Drag by 100 right and 40 down: the same place goes with it.
        actions = self.page.pointer()
        self.page.move_to(actions, *place)
        actions.click_and_hold().move_by_offset(50, 20).move_by_offset(50, 20).release().perform()
        moved = self.page.pixel(*place)
        self.assertAlmostEqual(moved[0] - pixel[0], 100, delta=2)
        self.assertAlmostEqual(moved[1] - pixel[1], 40, delta=2)
        self.page.keys("+", "+", "-", Keys.ARROW_LEFT)
        self.assertAlmostEqual(self.page.read("view.scale") / zoomed["scale"], 1.25)
        self.assertAlmostEqual(self.page.read("view.y") - zoomed["y"], (60 / 1.25 + 100) / zoomed["scale"], delta=0.2)
        self.page.keys("f")  # the farthest point is another one in each scan
        self.page.element("fit").click()
        view = self.page.read("view")
        self.assertEqual((view["x"], view["y"]), (0, 0))
        farthest = max(math.hypot(*point) for point in self.page.scan())
        self.assertAlmostEqual(min(view["width"], view["height"]) / 2 / view["scale"] / farthest, 1.08, delta=0.01)

    def trails(self, seconds):
        self.driver.execute_script(
            """const slider = document.getElementById('trails'); slider.value = arguments[0];
               slider.dispatchEvent(new Event('input'));""", seconds)
        until(lambda: self.page.read("trail_s") == seconds, "the length of the trails")

    def test_trails(self):
        self.trails(2)
        until(lambda: self.page.read("scan.trails") >= 9, "two seconds of scans")
        self.assertLessEqual(self.page.read("scan.trails"), 16)
        self.trails(0)
        until(lambda: self.page.read("scan.trails") == 0, "no trails")
        self.trails(2)
        until(lambda: self.page.read("scan.trails") >= 4, "trails again")
        self.page.keys(" ")
        self.trails(0)  # of a frozen picture, too
        until(lambda: self.page.read("scan.trails") == 0, "no trails while it is frozen")

    def test_keyboard_alone_reaches_everything(self):
        reached = set()
        self.driver.execute_script("document.activeElement.blur()")
        actions = self.page.pointer()
        for _ in range(30):
            actions.send_keys(Keys.TAB).perform()
            reached.add(self.driver.switch_to.active_element.get_attribute("id"))
        for name in ("points", "zoom_in", "zoom_out", "fit", "freeze", "ruler", "save", "trails", "help"):
            self.assertIn(name, reached)
        self.page.keys("?")
        self.assertTrue(self.page.element("keys").is_displayed())
        self.driver.switch_to.active_element.send_keys(Keys.ESCAPE)
        self.assertFalse(self.page.element("keys").is_displayed())


class PhoneTest(PageTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.server = Server(standing("flat.txt"))
        cls.addClassCleanup(cls.server.stop)

    def setUp(self):
        self.command("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=3, mobile=True)
        self.command("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        self.addCleanup(self.command, "Emulation.clearDeviceMetricsOverride")
        self.addCleanup(self.command, "Emulation.setTouchEmulationEnabled", enabled=False)
        self.addCleanup(self.command, "Emulation.setEmulatedMedia", media="", features=[])

    def command(self, name, **values):
        return self.driver.execute_cdp_cmd(name, values)

    def touch(self, kind, *places):
        self.command("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": i}
                                                                         for i, (x, y) in enumerate(places)])

    def test_fits_and_pinches(self):
        page = self.open(self.server).runs()
        width, wide = self.driver.execute_script(
            "return [document.documentElement.clientWidth, document.documentElement.scrollWidth]")
        self.assertEqual((width, wide), (390, 390))
        self.assertGreater(page.read("view.height"), 844 / 2)
        for name in ("points", "orientation", "legend", "zoom_in", "freeze", "ruler", "trails", "state"):
            self.assertTrue(page.element(name).is_displayed(), name)
        small = self.driver.execute_script(
            """return [...document.querySelectorAll('#tools button')].filter((each) => {
                 const box = each.getBoundingClientRect();
                 return box.width < 40 || box.height < 44 || box.right > 390; }).map((each) => each.id)""")
        self.assertEqual(small, [])
        box = self.driver.execute_script("const b = document.getElementById('points').getBoundingClientRect();"
                                         "return [b.left + b.width / 2, b.top + b.height / 2]")
        before = page.read("view")
        self.touch("touchStart", (box[0] - 30, box[1]), (box[0] + 30, box[1]))
        for apart in (40, 50, 60):
            self.touch("touchMove", (box[0] - apart, box[1]), (box[0] + apart, box[1]))
        self.touch("touchEnd")
        until(lambda: page.read("view.scale") > 1.9 * before["scale"], "zoomed by a pinch")
        view = page.read("view")
        self.assertAlmostEqual(view["scale"] / before["scale"], 2, delta=0.01)
        self.assertAlmostEqual(view["x"], before["x"], delta=1 / view["scale"])
        self.assertAlmostEqual(view["y"], before["y"], delta=1 / view["scale"])

    def test_preferences(self):
        def shown(**features):
            self.command("Emulation.setEmulatedMedia", media="screen", features=[
                {"name": f"prefers-{name.replace('_', '-')}", "value": value} for name, value in features.items()])
            page = self.open(self.server).runs()
            colour = self.driver.execute_script("return getComputedStyle(document.body).backgroundColor")
            return sum(int(word) for word in colour[4:-1].split(",")) / 3, page.read("trail_s")

        light, trail_s = shown(color_scheme="light")
        self.assertGreater(light, 240)
        self.assertGreater(trail_s, 0)
        dark, trail_s = shown(color_scheme="dark", reduced_motion="reduce")
        self.assertLess(dark, 40)
        self.assertEqual(trail_s, 0)


if __name__ == "__main__":
    unittest.main()
