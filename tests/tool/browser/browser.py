"""Chromium without a window, and what npm has for tests of a page; scripts/setup brings both."""

import glob
import os
import tempfile

CACHE = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
FLAGS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage")


def node_modules():
    trees = sorted(glob.glob(os.path.join(CACHE, "ocm", "serve-*", "node_modules")))
    if not trees:
        raise AssertionError(f"no axe-core in {CACHE}/ocm: run scripts/setup")
    return trees[-1]


class Browser:
    """`width` and `height` are those of the page."""

    def __init__(self, width=1280, height=1400):
        from selenium import webdriver
        from selenium.webdriver.chrome.options import Options
        from selenium.webdriver.chrome.service import Service
        self._profile = tempfile.TemporaryDirectory(prefix="ocm-chromium-", ignore_cleanup_errors=True)
        options = Options()
        options.binary_location = "/usr/bin/chromium"
        for flag in (*FLAGS, f"--user-data-dir={self._profile.name}"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
        self.driver.set_page_load_timeout(120)
        self.size(width, height)

    def size(self, width, height, scale=1):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                    {"width": width, "height": height, "deviceScaleFactor": scale, "mobile": False})

    def prefer(self, scheme):
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})

    def open(self, url):
        self.driver.get("about:blank")  # only another fragment would load nothing
        self.driver.get(url)

    def script(self, text, *arguments):
        return self.driver.execute_script(text, *arguments)

    def text(self, selector):
        """Of the first such element; None: there is none."""
        return self.script("return document.querySelector(arguments[0])?.textContent ?? null", selector)

    def element(self, selector):
        return self.driver.find_element("css selector", selector)

    def processes(self):
        """Of Chromium: what chromedriver has started, and what that has."""
        parents = {}
        for stat in glob.glob("/proc/[0-9]*/stat"):
            try:
                with open(stat, encoding="utf-8", errors="replace") as file:
                    parents[int(stat.split("/")[2])] = int(file.read().rpartition(")")[2].split()[1])
            except OSError:
                pass  # it has just ended
        found = [self.driver.service.process.pid]
        for pid in found:
            found += [child for child, parent in parents.items() if parent == pid]
        return found[1:]

    def complaints(self):
        """What the console has of errors and of the page's policy."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]

    def violations(self):
        """Of axe-core: rule and elements."""
        with open(os.path.join(node_modules(), "axe-core", "axe.min.js"), encoding="utf-8") as file:
            self.script(file.read())
        found = self.driver.execute_async_script(
            "const done = arguments[arguments.length - 1]; axe.run().then(result => done(result.violations), error => done([{id: String(error), nodes: []}]))")
        return [(each["id"], [node["html"] for node in each["nodes"]][:3]) for each in found]

    def close(self):
        self.driver.quit()
        self._profile.cleanup()
