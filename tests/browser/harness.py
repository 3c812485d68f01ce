# SPDX-License-Identifier: MIT
"""g4-serve and a headless Chromium for the tests of the page. G4_SERVE and G4_DUMP name the programs."""
import math
import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import time
import unittest
import urllib.request

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select

ROOT = pathlib.Path(__file__).resolve().parents[2]
WORLDS = ROOT / "examples" / "worlds"
PATIENCE_S = float(os.environ.get("PATIENCE", 30))  # of a busy machine

scratch = tempfile.TemporaryDirectory()


def until(condition, what, patience_s=PATIENCE_S):
    """Waits until the condition returns something true, and returns that."""
    end = time.monotonic() + patience_s
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"not within {patience_s} s: {what}")
        time.sleep(0.05)


def standing(world, *more):
    """The source of a simulated lidar that stands at the begin of a world's path."""
    stands = pathlib.Path(scratch.name) / "stands.txt"
    stands.write_text("drive wait 1\n", encoding="utf-8")
    return "&".join([f"sim:?world={WORLDS / world}", f"path={stands}", *more])


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


class Server:
    """A running g4-serve."""

    def __init__(self, source, *options, port=None, directory=ROOT):
        self.port = port or free_port()
        self.url = f"http://127.0.0.1:{self.port}/"
        self.log = open(pathlib.Path(scratch.name) / f"serve-{self.port}.txt", "ab")
        words = [os.environ["G4_SERVE"], str(source), "--port", str(self.port), *options]
        self.process = subprocess.Popen(words, stderr=self.log, stdout=self.log, cwd=directory)
        until(self._answers, "g4-serve answers")

    def _answers(self):
        if self.process.poll() is not None:
            raise AssertionError(f"g4-serve has ended: {pathlib.Path(self.log.name).read_text('utf-8')}")
        try:
            with urllib.request.urlopen(self.url, timeout=5) as answer:
                return answer.status == 200
        except OSError:
            return False

    def stop(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            self.process.wait(PATIENCE_S)
        self.log.close()


def new_driver():
    options = webdriver.ChromeOptions()
    options.binary_location = os.environ.get("CHROMIUM", "/usr/bin/chromium")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    for word in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1280,900",
                 "--disable-background-timer-throttling", "--disable-renderer-backgrounding"):
        options.add_argument(word)
    service = Service(os.environ.get("CHROMEDRIVER", "/usr/bin/chromedriver"))
    driver = webdriver.Chrome(service=service, options=options)
    driver.set_script_timeout(PATIENCE_S)
    return driver


class Page:
    """A tab with the page."""

    def __init__(self, driver, url):
        self.driver = driver
        self.url = url
        driver.get(url)
        self.tab = driver.current_window_handle

    def read(self, what):
        """A part of window.g4lidar, such as "view.scale"."""
        return self.driver.execute_script(f"return window.g4lidar.{what}")

    def scan(self):
        """The points of the scan that is shown: pairs of metres."""
        flat = self.read("scan?.points") or []
        return list(zip(flat[::2], flat[1::2]))

    def whole_scan(self):
        until(lambda: self.read("scan?.whole"), "a whole scan is shown")
        return self.scan()

    def state(self):
        return self.element("state").get_attribute("data-state")

    def runs(self):
        until(lambda: self.state() == "running" and self.read("scan"), "the lidar runs")
        return self

    def element(self, name):
        return self.driver.find_element(By.ID, name)

    def text(self, name):
        """Also of an element that is not visible."""
        return self.element(name).get_attribute("textContent")

    def keys(self, *keys, at="points"):
        self.element(at).send_keys(*keys)

    def pixel(self, x, y):
        """Where a place of the robot's frame is in the picture: x ahead is up."""
        view = self.read("view")
        return (view["width"] / 2 - (y - view["y"]) * view["scale"],
                view["height"] / 2 - (x - view["x"]) * view["scale"])

    def pointer(self):
        return ActionChains(self.driver, duration=0)

    def move_to(self, actions, x, y):
        """Moves the mouse to a place of the robot's frame; returns the place of that whole pixel."""
        view = self.read("view")
        column, row = (round(each) for each in self.pixel(x, y))
        surface = self.element("points")
        actions.move_to_element_with_offset(surface, column - int(view["width"] / 2), row - int(view["height"] / 2))
        return (view["x"] + (view["height"] / 2 - row) / view["scale"],
                view["y"] + (view["width"] / 2 - column) / view["scale"])

    def alpha(self, places):
        """The opacity of the pixels at these places, 0 to 255."""
        pixels = [[round(each) for each in self.pixel(*place)] for place in places]
        return self.driver.execute_script(
            """const canvas = document.getElementById('points'), context = canvas.getContext('2d');
               const ratio = canvas.width / window.g4lidar.view.width;
               return arguments[0].map(([column, row]) =>
                 context.getImageData(column * ratio, row * ratio, 1, 1).data[3]);""", pixels)

    def faults(self):
        """What the browser has logged as an error, such as an exception or a breach of the CSP."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]


class PageTest(unittest.TestCase):
    """Has one browser. Fails if the browser logs an error, other than those in `expected_faults`."""

    expected_faults = ()
    driver = None

    @classmethod
    def setUpClass(cls):
        if PageTest.driver is None:
            PageTest.driver = new_driver()
            unittest.addModuleCleanup(close_driver)

    def open(self, server):
        return Page(self.driver, server.url)

    def serve(self, *words, **named):
        server = Server(*words, **named)
        self.addCleanup(server.stop)
        return server

    def tearDown(self):
        faults = [each for each in Page.faults(self) if not any(word in each for word in self.expected_faults)]
        self.assertEqual(faults, [])


def close_driver():
    PageTest.driver.quit()
    PageTest.driver = None


def bearing_deg(x, y):
    return math.degrees(math.atan2(y, x))
