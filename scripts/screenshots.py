# SPDX-License-Identifier: MIT
"""Pictures of the page: screenshots.py DIRECTORY. The directory tests/browser has to be in PYTHONPATH."""
import pathlib
import sys
import time

from harness import WORLDS, Keys, Page, Server, new_driver, scratch, until

MOST_BYTES = 150_000


def take(driver, server, path, width, height, scale, is_phone, metre_pixels):
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
        "width": width, "height": height, "deviceScaleFactor": scale, "mobile": is_phone})
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
        "features": [{"name": "prefers-color-scheme", "value": "dark" if is_phone else "light"}]})
    page = Page(driver, server.url).runs()
    driver.execute_script("""const slider = document.getElementById('trails'); slider.value = '2';
                             slider.dispatchEvent(new Event('input'));""")
    while page.read("view.scale") < metre_pixels:
        page.keys("+")
    while page.read("view.scale") > 1.25 * metre_pixels:
        page.keys("-")
    while page.read("view.x") < 3.2:
        page.keys(Keys.ARROW_UP)
    driver.execute_script("document.activeElement.blur()")
    time.sleep(3)  # trails
    until(lambda: page.text("verdict") == "ok", "the doctor finds no fault; the machine has to be idle", 120)
    driver.save_screenshot(str(path))
    size = path.stat().st_size
    print(f"{path}: {size} bytes")
    if size > MOST_BYTES:
        sys.exit(f"{path} has more than {MOST_BYTES} bytes")


def write_world(name, place):
    """people.txt with a robot that stands, and its lidar at this place on it."""
    lines = (WORLDS / "people.txt").read_text("utf-8").splitlines()
    stands = [line for line in lines if not line.startswith(("drive", "mount"))]
    pathlib.Path(scratch.name, name).write_text("\n".join([*stands, f"mount {place}", ""]), encoding="utf-8")


def main():
    docs = pathlib.Path(sys.argv[1])
    front, rear = "1,0.4,0", "-1,-0.4,180"  # of a long vehicle
    for name, place in (("people.txt", "0,0,0"), ("front.txt", front), ("rear.txt", rear)):
        write_world(name, place)
    driver = new_driver()
    servers = []
    try:
        servers.append(Server("sim:?world=people.txt", directory=scratch.name))
        take(driver, servers[0], docs / "serve.png", 1160, 740, 1, False, 40)
        take(driver, servers[0], docs / "serve_phone.png", 390, 844, 1.5, True, 26)
        servers.append(Server("front=sim:?world=front.txt", "rear=sim:?world=rear.txt", "--merge", "--mount",
                              f"front={front}", "--mount", f"rear={rear}", directory=scratch.name))
        take(driver, servers[1], docs / "serve_lidars.png", 900, 640, 1, False, 40)
    finally:
        driver.quit()
        for server in servers:
            server.stop()


main()
