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


def main():
    docs = pathlib.Path(sys.argv[1])
    world = (WORLDS / "people.txt").read_text("utf-8")
    stands = [line for line in world.splitlines() if not line.startswith("drive")]
    pathlib.Path(scratch.name, "people.txt").write_text("\n".join(stands), encoding="utf-8")
    server = Server("sim:?world=people.txt", directory=scratch.name)
    driver = new_driver()
    try:
        take(driver, server, docs / "serve.png", 1200, 780, 1, False, 40)
        take(driver, server, docs / "serve_phone.png", 390, 844, 1.5, True, 26)
    finally:
        driver.quit()
        server.stop()


main()
