"""Robots behind a central on the page, in Chromium: the map grows, a click sends a robot, all can use it; and pages that other verbs open."""

import math
import os
import re
import sys

sys.path.insert(0, os.path.join(os.environ["OCM_SOURCE_DIR"], "tests", "tool", "verbs"))
import browser
import harness
from played_central import Central, Robot
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

# Pixels of the map that are dark and light, as walls and free cells are in the light scheme.
SHADES = """const canvas = document.getElementById('map');
const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
let [dark, light] = [0, 0];
for (let i = 0; i < data.length; i += 4) {
  if (data[i + 3] < 255) continue;
  const sum = data[i] + data[i + 1] + data[i + 2];
  if (sum < 120) ++dark;
  if (sum > 750) ++light;
}
return [dark, light];"""


class Robots(harness.Case):
    @classmethod
    def setUpClass(cls):
        cls.browser = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def setUp(self):
        super().setUp()
        self.browser.size(1280, 1400)
        self.browser.prefer("light")
        self.browser.open("about:blank")  # the page of the test before says that its server is gone
        self.browser.complaints()

    def play(self):
        self.avr = Robot("AVR", pose=(0.4, 0.5, 0.0))
        self.arduino = Robot("Arduino", pose=(0.8, 0.5, 1.5707963))
        self.avr.room = self.arduino.room = (0.0, 0.0, 2.4, 1.0)
        self.central = Central(self.folder, [self.avr, self.arduino], link="ocm/central")
        self.addCleanup(self.central.close)

    def serve(self, *arguments, tool=()):
        self.server = self.start(*(tool or ("serve", "robots")), "--port", "0", *arguments)
        self.url = self.server.stdout.readline().strip()
        self.browser.open(self.url)
        self.until(lambda: self.browser.text("#link") == "connected", "the connection")

    def serve_robots(self, *arguments):
        self.play()
        self.serve("--scan", "200ms", "--start", "AVR=0.4,0.5,0", "--start", "Arduino=0.8,0.5,90", *arguments)
        self.until(lambda: self.area() > 0 and "Arduino at" in self.browser.text("#map-text"), "the map with both robots")

    @staticmethod
    def until(holds, what):
        harness.waiting.until(holds, what)

    def fine(self):
        self.assertEqual(self.browser.complaints(), [])

    def area(self):
        """m2 that are free, as the page says it."""
        found = re.match(r"([\d.]+) m\u00b2 free", self.browser.text("#map-text"))
        return float(found[1]) if found else 0

    def place(self, name):
        found = re.search(rf"{name} at (-?[\d.]+) m, (-?[\d.]+) m", self.browser.text("#map-text"))
        return (float(found[1]), float(found[2])) if found else None

    def row(self, name):
        return self.browser.script("""const line = [...document.querySelectorAll('#fleet-table tbody tr')].find(each => each.children[0].textContent === arguments[0]);
            return line ? [...line.children].map(each => each.textContent) : []""", name)

    def choose(self, name):
        self.browser.script("""const select = document.getElementById('fleet-robot');
            select.value = [...select.options].find(each => each.textContent === arguments[0]).value""", name)

    def press(self, order):
        self.browser.element(f'[data-order="{order}"]').click()

    def says(self, words):
        self.until(lambda: words in self.browser.text("#messages"), words)

    def test_the_map_grows(self):
        self.serve_robots()
        first = self.area()
        self.until(lambda: self.row("AVR")[1:] == ["idle", "0.40 m, 0.50 m", "0\u00b0", "100 %"], "the robot's row")
        self.run_tool("goto", "AVR", "0", "100")
        self.until(lambda: self.area() > first + 0.1, "more of the map")
        self.until(lambda: min(self.browser.script(SHADES)) > 200, "walls and free cells on the canvas")
        self.until(lambda: self.row("AVR")[2] == "1.40 m, 0.50 m", "where it is now")
        self.until(lambda: self.row("Arduino")[3] == "90\u00b0", "the heading of the other one")
        for part in ("#fleet-orders", "#robot", "#graphs-part", "#bus-part", "#values-part", "#command"):
            self.assertFalse(self.browser.element(part).is_displayed(), part)
        self.fine()

    def test_a_log_has_a_time_bar(self):
        """The map grows from what was recorded, and is small again where the log is wound back."""
        self.play()
        log = os.path.join(self.folder, "room.line")
        owner = self.start("central", "--own", "--scan", "200ms", "--record", log)
        harness.waiting.until(lambda: self.avr.confirmed and self.arduino.confirmed, "its robots")
        self.run_tool("goto", "AVR", "0", "100")
        self.interrupt(owner)
        self.central.close()
        self.serve("--start", "AVR=0.4,0.5,0", "--start", "Arduino=0.8,0.5,90", tool=("serve", log))
        self.until(lambda: self.browser.element("#bar").is_displayed(), "the time bar")
        wind = "const bar = document.getElementById('bar'); bar.value = arguments[0]; bar.dispatchEvent(new Event('change'))"
        self.browser.element("#play").click()
        self.until(lambda: self.browser.text("#play") == "Play log", "the pause")
        self.browser.script(wind, 1000)
        self.until(lambda: "end" in self.browser.text("#bar-text") and self.row("AVR")[2:3] == ["1.40 m, 0.50 m"], "its end")
        self.until(lambda: self.area() > 0.2, "the map")
        self.until(lambda: min(self.browser.script(SHADES)) > 200, "walls and free cells on the canvas")
        self.assertEqual(self.browser.text("#play"), "Play again")
        self.browser.script(wind, 0)
        self.until(lambda: self.browser.text("#bar-text").startswith("0.0 of") and self.area() == 0 and not self.place("AVR"), "its beginning")
        self.assertFalse(self.browser.element("#fleet-orders").is_displayed())
        self.fine()

    def test_a_click_sends_a_robot(self):
        self.serve_robots("--allow-commands")
        self.until(lambda: self.area() > 1.1, "all that both see from where they stand")  # what is clicked on must be known
        self.choose("AVR")
        canvas = self.browser.element("#map")
        where = self.browser.script("""const box = arguments[0].getBoundingClientRect();
            return [box.width, box.height]""", canvas)
        # A little above the middle, which is free: the robots are left and right of it.
        ActionChains(self.browser.driver).move_to_element_with_offset(canvas, 0, -round(where[1] * 0.15)).click().perform()
        self.until(lambda: any(line.startswith("{U,") for line in self.avr.heard), "it is sent")
        self.says("AVR is there")
        # Where that is depends on how much of the map is known when it is clicked: the order says it, from its start.
        angle, centimetres = map(int, re.match(r"\{U,(-?\d+),(\d+)", next(line for line in self.avr.heard if line.startswith("{U,"))).groups())
        goal = (0.4 + centimetres / 100 * math.cos(math.radians(angle)), 0.5 + centimetres / 100 * math.sin(math.radians(angle)))
        self.assertGreater(goal[1], 0.5)
        self.until(lambda: self.place("AVR") is not None and math.dist(self.place("AVR"), goal) < 0.1, "it has come there")
        self.assertFalse(any(line.startswith("{U,") for line in self.arduino.heard))
        # By the keyboard, for the other one.
        heard = len(self.avr.heard)
        self.choose("Arduino")
        self.browser.element("#place-x").clear()
        self.browser.element("#place-x").send_keys("0.8")
        self.browser.element("#place-y").clear()
        self.browser.element("#place-y").send_keys("0.6", Keys.ENTER)
        self.says("Arduino is there")
        self.assertIn("{U,0,10}", self.arduino.heard)
        self.assertFalse(any(line.startswith("{U,") for line in self.avr.heard[heard:]))
        self.fine()

    def test_pause_call_back_stop(self):
        self.serve_robots("--allow-commands")
        self.choose("AVR")
        self.press("pause")
        self.says("AVR is paused")
        self.until(lambda: self.row("AVR")[1] == "paused", "the pause")
        self.press("go_on")
        self.says("AVR goes on")
        self.avr.x = 0.6
        self.until(lambda: self.place("AVR") == (0.6, 0.5), "its place")
        self.press("call_back")
        self.says("AVR is there")
        self.until(lambda: self.place("AVR") is not None and abs(self.place("AVR")[0] - 0.4) < 0.05, "it has come back")
        self.press("stop")
        self.until(lambda: self.avr.heard[-1] == "{U,0,0}", "the stop")
        self.browser.element("#fleet-look").click()
        self.until(lambda: "it looks for robots" in self.browser.text("#fleet-line") or self.central.commands.count("start") > 1, "it looks")
        self.fine()

    def test_a_page_that_goes_away_stops_the_robot(self):
        self.serve_robots("--allow-commands")
        self.avr.speed = 1
        self.choose("AVR")
        self.browser.element("#place-x").clear()
        self.browser.element("#place-x").send_keys("0.7")
        self.browser.element("#place-y").clear()
        self.browser.element("#place-y").send_keys("0.5", Keys.ENTER)
        self.until(lambda: any(line.startswith("{U,") for line in self.avr.heard), "it is sent")
        self.until(lambda: "sent to 0.70 m" in self.browser.text("#map-text"), "its target")
        self.browser.open("about:blank")
        self.until(lambda: self.avr.heard[-1] == "{U,0,0}", "the stop")

    def test_all_can_use_it(self):
        """axe-core finds nothing, in light and dark, wide and on a phone, where nothing sticks out."""
        self.serve_robots("--allow-commands")
        self.press("pause")
        self.says("AVR is paused")
        for scheme in ("light", "dark"):
            for width, height in ((1280, 1400), (390, 844)):
                self.browser.prefer(scheme)
                self.browser.size(width, height)
                self.assertEqual(self.browser.violations(), [], (scheme, width))
                self.assertLessEqual(self.browser.script("return document.documentElement.scrollWidth"), width, (scheme, width))
        unreachable = self.browser.script("""return [...document.querySelectorAll('button, input, select')]
            .filter(each => each.offsetParent !== null && each.tabIndex < 0).map(each => each.outerHTML)""")
        self.assertEqual(unreachable, [])

    def test_the_central_goes(self):
        self.serve_robots()
        self.central.close()
        os.unlink(self.central.path)
        self.until(lambda: "waiting for it" in self.browser.text("#fleet-line"), "that it is gone")
        self.until(lambda: self.row("AVR") == [], "no robot any more")

    # --- pages that other verbs open ---

    def test_plot_live(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "50ms")
        self.serve("gyro.z", "odometry.pose.x", tool=("plot", "--live"))
        self.assertTrue(self.url.endswith("/#plot=/gyroscope.z,/odometry.pose.x"), self.url)
        self.until(lambda: self.browser.script("return [...document.querySelectorAll('#graphs figcaption strong')].map(each => each.textContent)")
                   == ["gyroscope z in deg/s", "odometry.pose x in m"], "both graphs")
        self.until(lambda: self.browser.script("return document.querySelectorAll('#graphs canvas').length") > 0, "a curve")
        self.fine()

    def test_sim_show(self):
        self.serve("--world", "square", "--robots", "1", "--allow-commands", tool=("sim", "--show"))
        self.assertTrue(self.url.endswith("&map"), self.url)
        self.until(lambda: self.browser.script("return document.querySelectorAll('#fleet-table tbody tr').length") == 1, "its mapper")
        self.until(lambda: self.area() > 0, "its map")
        _, err = self.interrupt(self.server)
        self.assertNotIn("gone", err)
        self.serve("--allow-commands", tool=("sim", "--show=page"))
        self.until(lambda: self.browser.element("#pad .up").is_displayed(), "the pad of the simulated robot")
        ActionChains(self.browser.driver).click_and_hold(self.browser.element("#pad .up")).perform()
        self.until(lambda: self.browser.text('[data-field="/motors.x"]') == "0.1 m/s", "it drives")
        ActionChains(self.browser.driver).release().perform()
        self.until(lambda: self.browser.text('[data-field="/motors.x"]') == "0 m/s", "it rests")
        self.fine()
        _, err = self.interrupt(self.server)
        self.assertEqual(self.server.returncode, 130)
        self.assertNotIn("amiroctl:", err)

    def test_map_live(self):
        self.play()
        self.serve("--scan", "200ms", "--start", "AVR=0.4,0.5,0", "--start", "Arduino=0.8,0.5,90",
                   tool=("map", os.path.join(self.folder, "room.svg"), "--live"))
        self.assertTrue(self.url.endswith("/#map"), self.url)
        self.until(lambda: "drawn by map (process" in self.browser.text("#map-text"), "the map of that program")
        first = self.area()
        self.until(lambda: self.area() > first, "more of it")
        self.fine()


if __name__ == "__main__":
    harness.main()
