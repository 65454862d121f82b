"""The page of amiroctl serve as a person meets it: what is sent is shown, graphs draw, a button drives, and all can use it."""

import os
import re
import signal
import sys
import time
import urllib.error
import urllib.request

sys.path.insert(0, os.path.join(os.environ["OCM_SOURCE_DIR"], "tests", "tool", "verbs"))
import browser
import harness
import websocket
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

# Whether anything is drawn on one of the canvases: pixels that are not as the first one.
DRAWN = """return [...document.querySelectorAll(arguments[0])].some(canvas => {
  const data = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  return data.some(pixel => pixel !== data[0]);
})"""


class Page(harness.Case):
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

    def serve(self, *arguments, tool=()):
        server = self.start(*tool, "serve", "--port", "0", *arguments)
        self.url = server.stdout.readline().strip()
        self.port = int(re.search(r":(\d+)/", self.url)[1])
        self.browser.open(self.url)
        self.until(lambda: self.browser.text("#link") == "connected", "the connection")
        self.until(lambda: self.browser.text("#title") != "amiroctl", "the robot's name")
        return server

    @staticmethod
    def until(holds, what):
        harness.waiting.until(holds, what)

    def value(self, field):
        return self.browser.text(f'[data-field="{field}"]')

    def shows(self, field, text):
        self.until(lambda: self.value(field) == text, f"{field} {text} on the page")

    def choose(self, *fields):
        for field in fields:
            self.browser.script("arguments[0].click()", self.browser.element(f'[data-field="{field}"] + td input'))

    def fine(self):
        """Nothing was refused by the page's policy, and no script has failed."""
        self.assertEqual(self.browser.complaints(), [])

    def dbc(self):
        """A message, and one of a multiplexer with three pages."""
        spec = os.path.join(self.folder, "car.dbc")
        with open(spec, "w", encoding="ascii") as file:
            file.write('VERSION ""\nNS_ :\nBS_:\nBU_: ECU\nBO_ 291 Engine: 8 ECU\n SG_ Speed : 0|16@1+ (0.25,0) [0|16000] "rpm" Vector__XXX\n'
                       ' SG_ TemperatureOfTheCoolantBehindThePump : 16|8@1+ (1,-40) [-40|215] "degC" Vector__XXX\n'
                       'BO_ 292 Cells: 8 ECU\n SG_ Page M : 0|8@1+ (1,0) [0|2] "" Vector__XXX\n'
                       + "".join(f' SG_ Cell{i} m{i} : 8|16@1+ (0.001,0) [0|65] "V" Vector__XXX\n' for i in range(3)))
        return spec

    def log(self):
        path = os.path.join(self.folder, "drive.log")
        with open(path, "w", encoding="ascii") as file:
            for i in range(300):
                file.write(f"({1000 + i / 10:.6f}) can0 608#{i % 256:02X}{i // 256:02X}00000000\n")
        return path

    def labels(self):
        return self.browser.script("return [...document.querySelectorAll('.dygraph-axis-label-x')].map(each => each.textContent)")

    def test_values_sent_are_values_seen(self):
        self.start_sim("--frozen")
        self.serve()
        for low, shown in ((0x10, "0.28 deg/s"), (0x7F, "2.2225 deg/s"), (0x00, "0 deg/s")):
            self.run_tool("send", f"608#{low:02X}0000000000")
            self.shows("/gyroscope.x", shown)
        self.run_tool("send", "602#0000000000000000")
        self.run_tool("send", "603#0110000200000000")
        self.shows("/odometry.pose.x", "1.048832 m")
        self.shows("/odometry.pose.y", "0.000512 m")
        self.until(lambda: "at 1.05 m, 0.00 m" in self.browser.text("#picture-text"), "the pose in words")
        self.assertTrue(self.browser.script(DRAWN, "#picture"))
        self.until(lambda: re.search(r"\d+ frames", self.browser.text("#buses")), "the bus")
        self.fine()

    def ring(self, **above):
        """A sample of the ring: counts of the spec's offsets, and above them those of some sensors."""
        for i, offset in enumerate((2289, 2302, 2420, 2350, 2318, 2272, 2382, 2269)):
            counts = offset + above.get(f"s{i + 1}", 0)
            self.run_tool("send", f"6{0x1F + i:02X}#{counts & 255:02X}{counts >> 8:02X}")

    def test_an_obstacle_that_is_there_from_the_beginning(self):
        """It is never said that there is none: of a sensor whose offset has not been seen nothing is known."""
        self.start_sim("--frozen")
        self.serve()
        self.ring(s3=100)
        self.says("not known yet what 1 of 8 sensors of the ring see")
        self.assertNotIn("no obstacle", self.browser.text("#picture-text"))
        self.ring(s3=100, s4=48217)
        self.says("nearest obstacle 0.4 cm; not known yet what 1 of 8 sensors of the ring see")
        self.browser.open(self.url)  # who comes later hears the same, of what came before
        self.says("nearest obstacle 0.4 cm; not known yet what 1 of 8 sensors of the ring see")
        for _ in range(8):  # of which an average is
            self.ring()
        self.says("no obstacle in sight")
        self.until(lambda: re.fullmatch("no obstacle in sight, [2-9] s ago", self.browser.text("#picture-text")), "that this was long ago")
        self.browser.open(self.url)
        self.says("no obstacle in sight")
        self.ring(s3=100)
        self.says("nearest obstacle 9.7 cm")
        self.fine()

    def says(self, words):
        """What the picture shows, however long ago it was."""
        self.until(lambda: re.sub(", [0-9]+ s ago", "", self.browser.text("#picture-text")) == words,
                   f"{words}, and not {self.browser.text('#picture-text')}")

    def test_a_graph_draws_and_zooms(self):
        self.start_sim()
        self.run_tool("publish", "gyro", "50ms")
        self.serve()
        self.until(lambda: self.value("/gyroscope.z"), "a value")
        self.assertFalse(self.browser.script(DRAWN, "#graphs canvas"))
        time.sleep(1)  # for a line to be seen
        self.choose("/gyroscope.x", "/gyroscope.z")
        self.until(lambda: self.browser.script(DRAWN, "#graphs canvas"), "a graph")
        self.assertEqual(self.browser.text("#graphs figcaption strong"), "gyroscope x, z in deg/s")
        self.browser.script("document.getElementById('pause').click()")
        before = self.labels()
        plot = self.browser.element(".plot")
        width = plot.size["width"]
        ActionChains(self.browser.driver).move_to_element_with_offset(plot, -width // 8, 0).click_and_hold() \
            .move_by_offset(width // 5, 0).release().perform()
        self.until(lambda: self.labels() != before, "another span of time")
        zoomed = self.labels()
        plot.send_keys("+")
        self.until(lambda: self.labels() != zoomed, "a span that is shorter still")
        closer = self.labels()
        ActionChains(self.browser.driver).double_click(plot).perform()
        self.until(lambda: self.labels() not in (zoomed, closer), "all of it again")
        self.choose("/gyroscope.x", "/gyroscope.z")
        self.assertIsNone(self.browser.text("#graphs figcaption"))
        self.fine()

    def speeds(self):
        viewer = websocket.Viewer(self.port)
        self.addCleanup(viewer.close)
        viewer.subscribe("/motors")
        return viewer

    def test_a_button_drives_and_its_release_stops(self):
        self.start_sim("--frozen")
        self.serve("--allow-commands")
        viewer = self.speeds()
        self.until(lambda: self.browser.element("#pad .up").is_displayed(), "the pad")
        ActionChains(self.browser.driver).click_and_hold(self.browser.element("#pad .up")).perform()
        self.assertEqual(viewer.message().fields, {"x": 0.1, "z": 0})
        self.assertEqual(viewer.message().fields, {"x": 0.1, "z": 0})  # again and again
        ActionChains(self.browser.driver).release().perform()
        while viewer.message().fields["x"] != 0:
            pass
        pad = self.browser.element("#pad")
        self.browser.script("arguments[0].focus()", pad)
        ActionChains(self.browser.driver).key_down(Keys.ARROW_LEFT).perform()
        while viewer.message().fields != {"x": 0, "z": 0.8}:
            pass
        ActionChains(self.browser.driver).key_up(Keys.ARROW_LEFT).perform()
        while viewer.message().fields != {"x": 0, "z": 0}:
            pass
        self.browser.element("#stop").click()
        self.assertEqual(viewer.message().fields, {"x": 0, "z": 0})
        self.browser.element("#line").send_keys("led 2 blue", Keys.ENTER)
        self.shows("/led_2.blue", "255")
        self.browser.element("#line").send_keys("fly", Keys.ENTER)
        self.until(lambda: "unknown command" in self.browser.text("#messages"), "what is wrong")
        self.fine()

    def test_a_page_that_goes_away_stops_the_robot(self):
        self.start_sim("--frozen")
        self.serve("--allow-commands")
        viewer = self.speeds()
        self.until(lambda: self.browser.element("#pad .up").is_displayed(), "the pad")
        for leave in (lambda: self.browser.driver.get("about:blank"), lambda: self.browser.script("location.reload()")):
            ActionChains(self.browser.driver).click_and_hold(self.browser.element("#pad .up")).perform()
            while viewer.message().fields["x"] != 0.1:
                pass
            leave()
            begin = time.monotonic()
            while viewer.message().fields["x"] != 0:
                pass
            self.assertLess(time.monotonic() - begin, 3 + self.spare.slack)  # 500 ms, and a browser under load
            ActionChains(self.browser.driver).reset_actions()
            self.browser.open(self.url)
            self.until(lambda: self.browser.element("#pad .up").is_displayed(), "the pad")

    def test_a_page_that_was_frozen_does_not_drive_on(self):
        self.start_sim("--frozen")
        self.serve("--allow-commands")
        viewer = self.speeds()
        self.until(lambda: self.browser.element("#pad .up").is_displayed(), "the pad")
        ActionChains(self.browser.driver).click_and_hold(self.browser.element("#pad .up")).perform()
        while viewer.message().fields["x"] != 0.1:
            pass
        processes = self.browser.processes()
        for pid in processes:
            os.kill(pid, signal.SIGSTOP)
        while viewer.message().fields["x"] != 0:
            pass
        time.sleep(1)  # frozen for longer than a drive lasts
        for pid in processes:
            os.kill(pid, signal.SIGCONT)
        self.assertEqual(viewer.message().fields, {"x": 0, "z": 0})  # the page releases by itself, and says nothing else
        time.sleep(1)  # in which it would say ten set points
        self.browser.script("document.getElementById('stop').click()")
        self.assertEqual(viewer.message().fields, {"x": 0, "z": 0})  # behind which nothing of before is under way
        ActionChains(self.browser.driver).release().click_and_hold(self.browser.element("#pad .up")).perform()
        while viewer.message().fields["x"] != 0.1:  # what is pressed again drives
            pass
        ActionChains(self.browser.driver).release().perform()

    def test_without_the_token_there_is_nothing_to_press(self):
        self.start_sim("--frozen")
        self.serve("--allow-commands")
        self.browser.open(self.url.partition("#")[0])
        self.until(lambda: self.browser.text("#title") != "amiroctl", "the page")
        for selector in ("#pad", "#stop", "#line", "#ask"):
            self.assertFalse(self.browser.element(selector).is_displayed(), selector)

    def test_a_wrong_token_is_told(self):
        self.start_sim("--frozen")
        self.serve("--allow-commands")
        self.browser.open("about:blank")  # a fragment alone loads nothing again
        self.browser.open(self.url.partition("#")[0] + "#" + "0" * 32)
        self.until(lambda: "is not that of this server, so you only look" in self.browser.text("#messages"), "the reason")
        self.assertFalse(self.browser.element("#pad").is_displayed())
        time.sleep(11)  # a remark goes after ten seconds; this is no remark
        self.assertIn("so you only look", self.browser.text("#messages"))

    def test_a_log_with_its_time_bar(self):
        self.serve(self.log())
        self.until(lambda: self.browser.element("#bar").is_displayed(), "the time bar")
        self.browser.element("#play").click()
        self.until(lambda: self.browser.text("#play") == "Play log", "the pause")
        self.browser.script("const bar = document.getElementById('bar'); bar.value = 20; bar.dispatchEvent(new Event('change'))")
        self.until(lambda: self.browser.text("#bar-text").startswith("20.0 of 29.9 s"), "second 20")
        self.shows("/gyroscope.x", "3.5 deg/s")
        self.until(lambda: "sends; not asked yet" in self.browser.text("#board-table"), "the boards")
        self.assertEqual(self.browser.text("#findings"), "")  # none was asked, so none is found silent
        self.browser.script("const bar = document.getElementById('bar'); bar.value = 29.8; bar.dispatchEvent(new Event('change'))")
        self.until(lambda: self.browser.text("#bar-text").startswith("29.8"), "second 29.8")
        self.browser.element("#play").click()
        self.until(lambda: self.browser.text("#play") == "Play again" and "end" in self.browser.text("#bar-text"), "the end")
        self.browser.element("#play").click()
        self.until(lambda: self.browser.text("#play") == "Pause log" and float(self.browser.text("#bar-text").split()[0]) < 20, "its beginning again")
        self.fine()

    def test_any_dbc_has_values_and_graphs(self):
        spec = os.path.join(self.folder, "car.dbc")
        with open(spec, "w", encoding="ascii") as file:
            file.write('VERSION ""\nNS_ :\nBS_:\nBU_: ECU\nBO_ 291 Engine: 8 ECU\n SG_ Speed : 0|16@1+ (0.25,0) [0|16000] "rpm" Vector__XXX\n'
                       'VAL_ 291 Speed 8 "slow" ;\n')
        log = os.path.join(self.folder, "car.log")
        with open(log, "w", encoding="ascii") as file:
            file.write("".join(f"({10 + i / 10:.6f}) can0 123#{min(i, 8):02X}00000000000000\n" for i in range(200)))
        self.serve(log, tool=("--spec", spec))
        self.until(lambda: self.value("/Engine.Speed") == "2 rpm slow", "a value with its name")
        self.choose("/Engine.Speed")
        self.until(lambda: self.browser.script(DRAWN, "#graphs canvas"), "a graph")
        for selector in ("#robot", "#boards"):
            self.assertFalse(self.browser.element(selector).is_displayed(), selector)
        self.fine()

    def test_each_field_of_a_multiplexer_has_its_newest_value(self):
        self.start_sim("--frozen")
        self.serve(tool=("--spec", self.dbc()))
        for page, millivolts in ((0, 3600), (1, 3700), (2, 3800), (0, 3601)):
            self.run_tool("send", f"124#{page:02X}{millivolts & 255:02X}{millivolts >> 8:02X}0000000000")
        for i, text in enumerate(("3.601 V", "3.7 V", "3.8 V")):
            self.shows(f"/Cells.Cell{i}", text)

        def age(field):
            text = self.browser.script("return arguments[0].parentElement.children[6].textContent", self.browser.element(f'[data-field="/Cells.{field}"]'))
            shown = re.match(r"([0-9.]+) (m?s)", text)
            return float(shown[1]) * (0.001 if shown[2] == "ms" else 1) if shown else float("nan")  # not yet

        self.until(lambda: age("Cell1") > age("Cell2") > age("Page"), "ages: pages that came before are older")
        self.run_tool("send", "124#01750E0000000000")
        self.shows("/Cells.Cell1", "3.701 V")
        self.until(lambda: age("Cell1") < age("Cell0"), "the age of what has just come")
        self.assertEqual(self.value("/Cells.Cell0"), "3.601 V")
        self.fine()

    def test_a_command_line_with_any_spec(self):
        self.start_sim("--frozen")
        self.serve("--allow-commands", tool=("--spec", self.dbc()))
        self.until(lambda: self.browser.element("#line").is_displayed(), "the command line")
        self.assertEqual(self.browser.element("#line").get_attribute("placeholder"), "set Engine Speed=0")
        self.browser.element("#line").send_keys("set Engine Speed=100rpm", Keys.ENTER)
        self.shows("/Engine.Speed", "100 rpm")
        self.fine()

    def in_view(self, field):
        """Whether the value and the check box of a field are within the page's width."""
        return self.browser.script("""const cell = document.querySelector(`[data-field="${arguments[0]}"]`);
            return [cell, cell.nextSibling.firstChild].every(each => { const box = each.getBoundingClientRect();
              return box.width > 0 && box.left >= 0 && box.right <= innerWidth; })""", field)

    def test_values_on_a_phone(self):
        self.browser.size(390, 844)
        self.start_sim("--frozen")
        self.serve()
        self.run_tool("send", "602#0000000000000000")
        self.run_tool("send", "603#0110000200000000")
        self.ring()
        self.shows("/odometry.pose.x", "1.048832 m")
        for field in ("/odometry.pose.orientation", "/proximity_ring.sensor_1.proximity"):
            self.assertTrue(self.in_view(field), field)
        headings = "return [...document.querySelectorAll('#values tr.topic')].filter(each => each.offsetParent !== null).map(each => each.textContent)"
        self.assertEqual(self.browser.script(headings), ["odometry", "proximity_ring"])
        self.browser.element("#filter").send_keys("prox")
        self.until(lambda: self.browser.script(headings) == ["proximity_ring"], "the filter")
        self.assertEqual(self.browser.violations(), [])
        self.browser.size(1280, 1400)
        self.assertEqual(self.browser.script(headings), [])
        self.browser.size(390, 844)
        self.serve(tool=("--spec", self.dbc()))
        self.run_tool("send", "123#90013C0000000000")
        self.shows("/Engine.Speed", "100 rpm")
        self.assertTrue(self.in_view("/Engine.Speed"))
        self.assertTrue(self.in_view("/Engine.TemperatureOfTheCoolantBehindThePump"))
        self.assertLessEqual(self.browser.script("return document.documentElement.scrollWidth"), 390)

    def test_where_things_are(self):
        self.start_sim("--frozen")
        box = "const box = document.querySelector(arguments[0]).getBoundingClientRect(); return [box.left, box.top, box.right, box.bottom]"
        self.serve("--allow-commands")
        self.until(lambda: self.browser.element("#pad .up").is_displayed(), "the pad")
        gap = """const [pad, speed] = ['pad', 'forward-speed'].map(id => document.getElementById(id).getBoundingClientRect());
            return speed.top - pad.bottom"""
        self.assertGreaterEqual(self.browser.script(gap), 8)
        self.serve(tool=("--spec", self.dbc()))
        self.run_tool("send", "123#90013C0000000000")
        self.shows("/Engine.Speed", "100 rpm")
        (left, _, right, _), (bus_left, _, bus_right, _) = (self.browser.script(box, each) for each in ("#graphs-part", "#bus-part"))
        self.assertGreater(right - left, bus_right - bus_left)
        align = "return [...document.querySelectorAll('#values thead th')].map(each => getComputedStyle(each).textAlign)"
        cells = "return [...document.querySelector('[data-field=\"/Engine.Speed\"]').parentElement.children].map(each => getComputedStyle(each).textAlign)"
        self.assertEqual(self.browser.script(align), self.browser.script(cells))
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}/", headers={"Host": "evil.example"})
        for count in ("1 request refused", "2 requests refused"):
            with self.assertRaises(urllib.error.HTTPError):
                urllib.request.urlopen(request)
            self.until(lambda count=count: self.browser.text("#buses").endswith(f"1 viewer; {count}"), count)

    def test_all_can_use_it(self):
        """axe-core finds nothing, in light and dark, wide and on a phone, where nothing sticks out."""
        self.start_sim()
        for words in (("gyro", "100ms"), ("odom", "100ms"), ("power", "1s")):
            self.run_tool("publish", *words)
        self.serve("--allow-commands")
        self.run_tool("doctor", "--json")
        self.until(lambda: self.value("/gyroscope.x"), "a value")
        self.choose("/gyroscope.x")
        self.until(lambda: self.browser.script(DRAWN, "#graphs canvas"), "a graph")
        self.browser.element("#line").send_keys("fly", Keys.ENTER)
        self.until(lambda: "unknown command" in self.browser.text("#messages"), "a message")
        self.until(lambda: "same" in self.browser.text("#board-table"), "the boards")
        for scheme in ("light", "dark"):
            for width, height in ((1280, 1400), (390, 844)):
                self.browser.prefer(scheme)
                self.browser.size(width, height)
                self.assertEqual(self.browser.violations(), [], (scheme, width))
                self.assertLessEqual(self.browser.script("return document.documentElement.scrollWidth"), width, (scheme, width))
        # All of it can be reached by Tab, and it shows where it is.
        seen = self.browser.script("""return [...document.querySelectorAll('button, input, select')]
            .filter(each => each.offsetParent !== null && each.tabIndex < 0).map(each => each.outerHTML)""")
        self.assertEqual(seen, [])

    def test_the_page_knows_no_robot(self):
        folder = os.path.join(harness.SOURCE, "cli", "serve", "page")
        for name in os.listdir(folder):
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                self.assertIsNone(re.search(r"amiro(?!ctl)|di_wheel|gyroscope|proximity_ring", file.read(), re.IGNORECASE), name)


if __name__ == "__main__":
    harness.main()
