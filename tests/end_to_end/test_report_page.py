# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of `wardmis converge` in Chromium, from made-up reports (report_sample.py): that it draws what it is given, answers
to keys and pointers, fits wide and narrow windows, and asks no network for anything."""

import json
import re
import shutil
import tempfile
import time
import unittest
from pathlib import Path

import report_sample
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import Select, WebDriverWait

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
OPTIONS = (
    "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage",
)  # fmt: skip
WIDTHS = (1280, 390)
SECTIONS = [
    "error",
    "target",
    "equal",
    "images",
    "slope",
    "where",
    "cost",
    "prediction",
    "allocation",
    "ways",
    "models",
    "method",
]
# What of the page is wider than its window, by its own words.
TOO_WIDE = """return [...document.querySelectorAll('main *')].filter(e => !e.closest('svg, .modebar, .hidden, thead') && e.getClientRects().length
  && e.getBoundingClientRect().right > document.documentElement.clientWidth + 1).map(e => e.outerHTML.slice(0, 120))"""
# The colour of the canvas at a share of its width and height.
COLOUR = """const c = document.querySelector('canvas.main'), x = Math.floor(arguments[0] * c.width), y = Math.floor(arguments[1] * c.height);
  return [...c.getContext('2d').getImageData(x, y, 1, 1).data].slice(0, 3)"""


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not (CHROMIUM and DRIVER):
            raise AssertionError(
                "these tests need chromium and its driver: Debian's packages chromium and chromium-driver"
            )
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = Path(temporary.name)
        report_sample.write(cls.folder)
        cls.report, _ = report_sample.full()
        options = webdriver.ChromeOptions()
        options.binary_location = CHROMIUM
        for option in (*OPTIONS, f"--user-data-dir={cls.folder / 'profile'}"):
            options.add_argument(option)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        options.add_experimental_option("prefs", {"download.default_directory": str(cls.folder)})
        cls.driver = webdriver.Chrome(service=Service(DRIVER), options=options)
        cls.addClassCleanup(cls.driver.quit)

    def tearDown(self):
        said = [entry["message"] for entry in self.driver.get_log("browser")]
        self.assertEqual([text for text in said if "favicon" not in text], [])

    # ---- what the tests share

    def open(self, name="full", width=1280, scheme="light", touch=False):
        cdp = self.driver.execute_cdp_cmd
        screen = {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": width < 600}
        cdp("Emulation.setDeviceMetricsOverride", screen)
        cdp("Emulation.setTouchEmulationEnabled", {"enabled": touch})
        cdp("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
        self.driver.get((self.folder / f"{name}.html").as_uri())
        self.until(lambda: self.count(".curves .scatterlayer .trace"))
        if name == "full":
            self.until(lambda: self.count(".viewer[data-ready]"))
            self.until(lambda: self.canvas["drawn"] == "true")

    def until(self, condition):
        WebDriverWait(self.driver, 30, poll_frequency=0.05).until(lambda _: condition())

    def run_js(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def one(self, selector):
        return self.driver.find_element(By.CSS_SELECTOR, selector)

    def count(self, selector):
        return self.run_js("return document.querySelectorAll(arguments[0]).length", selector)

    def text(self, selector="main"):
        return self.run_js("return document.querySelector(arguments[0]).textContent", selector)

    @property
    def canvas(self):
        """What the viewer says of itself, once it has drawn what it was told."""
        self.run_js("return 0")
        self.driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
        return self.run_js("return {...document.querySelector('canvas.main').dataset}")

    def press(self, *keys):
        ActionChains(self.driver).send_keys(*keys).perform()

    def focus_viewer(self):
        self.run_js(
            "const c = document.querySelector('canvas.main'); c.scrollIntoView({block: 'center'}); c.focus({preventScroll: true})"
        )

    def show(self, group):
        Select(self.one("select[name=group]")).select_by_visible_text(group)

    def point_at(self, x, y):
        """Moves the pointer to a share of the canvas's width and height; returns what is told of the pixel."""
        canvas = self.one("canvas.main")
        size = canvas.size
        offset = (round((x - 0.5) * size["width"]), round((y - 0.5) * size["height"]))
        ActionChains(self.driver, duration=0).move_to_element_with_offset(canvas, *offset).perform()
        return self.text(".pixel")

    def traces(self):
        return self.run_js(
            "return document.querySelector('.curves').data.map(t => ({name: t.name, uid: t.uid, x: t.x, y: t.y, symbol: t.marker && t.marker.symbol}))"
        )

    # ---- the page

    def test_everything_is_there_in_order(self):
        self.open()
        self.assertEqual(
            self.run_js("return [...document.querySelectorAll('main > section')].map(s => s.id)"), SECTIONS
        )
        self.assertEqual(self.text("h1"), "veach")
        self.assertEqual(self.text(".verdict"), self.report["verdict"]["text"])
        self.assertEqual(self.text(".why"), " ".join(self.report["verdict"]["why"]))
        self.assertEqual(self.text(".finding"), " ".join(self.report["finding"]))
        self.assertIn("25 November 2026, 14:00 UTC", self.text(".when"))
        for plot, least in ((".curves", 5), (".forest", 3), (".histogram", 4)):
            self.assertGreaterEqual(self.count(f"{plot} .scatterlayer .trace"), least, plot)
        text = self.text()
        for words in (
            "0.571 [0.537, 0.606]",
            "not reached",
            "tie",
            "biased",
            "heavy tail",
            "differences, not errors",
            "mean (x − r)² / (r² + ε)",
            "anisotropy",
            "diffuse, specular, textures",
        ):
            self.assertIn(words, text)
        self.assertNotRegex(text, r"NaN|undefined|null|Infinity|\[object")
        self.assertEqual(self.count("[data-label=''] .share[aria-label]"), 3 + 4)

    def test_words_beside_the_map(self):
        self.open()
        where = self.driver.find_element(By.ID, "where").text
        self.assertEqual(where.count("although it is"), 1)
        self.assertIn(report_sample.MAP_REMARK, where)

    def test_headings_are_whole_when_they_are_read(self):
        self.open()
        titles = self.driver.execute_script("return [...document.querySelectorAll('h2')].map(e => e.textContent)")
        self.assertIn("Models differences, not errors", titles)

    def test_the_least_has_no_empty_section(self):
        self.open("minimal")
        self.assertEqual(
            self.run_js("return [...document.querySelectorAll('main > section')].map(s => s.id)"), ["error", "method"]
        )
        self.assertEqual(self.count("canvas, .viewer, .forest, .histogram"), 0)
        self.assertEqual(self.text("h1"), "a <b>bold</b> title </script>")
        self.assertEqual(self.driver.title, "a <b>bold</b> title </script>")
        self.assertIn("ended before its time", self.text(".notice"))
        self.assertIn("x<y>&z", self.text(".curves .legend"))
        self.assertNotRegex(self.text(), r"NaN|undefined|null|Infinity|\[object")
        self.assertEqual(
            self.run_js(
                "return [...document.querySelectorAll('h3, td, th, p')].filter(e => !e.textContent && !e.ariaLive).length"
            ),
            0,
        )

    def test_fits_wide_and_narrow_dark_and_light(self):
        for name in ("full", "minimal"):
            for width in WIDTHS:
                papers = {}
                for scheme in ("light", "dark"):
                    with self.subTest(name, width=width, scheme=scheme):
                        self.open(name, width, scheme)
                        scroll = self.run_js(
                            "return [document.documentElement.scrollWidth, document.documentElement.clientWidth]"
                        )
                        self.assertLessEqual(scroll[0], scroll[1])
                        self.assertEqual(self.run_js(TOO_WIDE), [])
                        scrolling = "return [...document.querySelectorAll('.table')].filter(e => e.scrollWidth > e.clientWidth).map(e => e.textContent.slice(0, 60))"
                        self.assertEqual(self.run_js(scrolling), [])
                        paper, ink, tick = self.run_js(
                            "const s = getComputedStyle(document.body); return [s.backgroundColor, s.color, getComputedStyle(document.querySelector('.curves .xtick text')).fill]"
                        )
                        self.assertEqual(tick, ink)
                        papers[scheme] = sum(map(int, re.findall(r"\d+", paper)[:3]))
                self.assertGreater(papers["light"], 3 * papers["dark"])

    def test_odd_reports_are_drawn(self):
        """One configuration, one checkpoint, eleven configurations, a heavy tail, errors of nothing, hardly anything known."""
        for name in report_sample.odd():
            for width in WIDTHS:
                with self.subTest(name, width=width):
                    self.open(name, width)
                    if (name, width) != ("crowd", 1280):  # whose table of groups scrolls in itself
                        self.assertEqual(self.run_js(TOO_WIDE), [])
                    self.assertLessEqual(self.run_js("return document.documentElement.scrollWidth"), width)
                    self.assertNotRegex(self.text(), r"NaN|undefined|null(?!\])|Infinity|\[object")
                    self.assertEqual(self.count("table tbody:empty, dl:empty, .pair:empty"), 0)
                    if name == "crowd":
                        looks = self.run_js(
                            "return [...document.querySelectorAll('#method .swatch')].map(e => e.innerHTML)"
                        )
                        self.assertEqual(len(set(looks)), 11)
                    if name == "heavy":
                        scrolling = "return [...document.querySelectorAll('.table')].filter(e => e.scrollWidth > e.clientWidth).length"
                        self.assertEqual(self.run_js(scrolling), 0)
                        self.assertEqual(self.count("table[aria-label='with all pixels'] tbody tr"), 6)
                        # names of any signs: the curves are drawn again
                        for axis in ("cpu", "spp"):
                            Select(self.one("select[name='against']")).select_by_value(axis)
                        drawn = "return [...document.querySelectorAll('.curves .js-line')].length"
                        self.assertGreaterEqual(self.run_js(drawn), 6)
                        self.assertIn("Samples per pixel", self.text(".curves"))
                    if name == "under":
                        self.assertIn("nothing is left", self.text("#error [aria-live]"))

    def test_theme_can_be_chosen(self):
        self.open(scheme="light")
        seen = []
        for _ in range(3):
            self.one(".theme").click()
            seen.append((self.text(".theme"), self.run_js("return document.documentElement.dataset.theme")))
        self.assertEqual(seen, [("Colours: dark", "dark"), ("Colours: light", "light"), ("Colours: auto", "light")])

    def test_nothing_is_fetched(self):
        self.driver.get_log("performance")
        self.open()
        self.point_at(0.5, 0.5)
        asked = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                asked.append(message["params"]["request"]["url"])
        self.assertEqual(len([url for url in asked if url.startswith("file:")]), 1)
        self.assertEqual([url[:80] for url in asked if not url.startswith(("file:", "data:", "blob:"))], [])
        self.assertEqual(
            self.run_js(
                "return performance.getEntriesByType('resource').map(e => e.name).filter(n => !/^(data|blob):/.test(n))"
            ),
            [],
        )

    # ---- the curves

    def test_curves_follow_the_selectors(self):
        self.open()
        equal = self.report["configurations"][0]["curve"]
        for metric, axis, of in (
            ("relmse", "wall", lambda p: p["wall"]["mean"]),
            ("mse", "cpu", lambda p: p["cpu"]["mean"]),
            ("flip", "rays", lambda p: p["rays"]),
            ("smape", "spp", lambda p: p["spp"]),
        ):
            with self.subTest(metric, axis=axis):
                Select(self.one("select[name=error]")).select_by_value(metric)
                Select(self.one("select[name=against]")).select_by_value(axis)
                traces = {trace["uid"]: trace for trace in self.traces()}
                self.assertEqual(traces["line-equal"]["x"], [of(p) for p in equal])
                self.assertEqual(traces["line-equal"]["y"], [p[metric]["mean"] for p in equal])
                self.assertEqual(len(traces["band-equal"]["x"]), 2 * len(equal))
                self.assertEqual("floor" in traces, metric in ("mse", "relmse"))
                self.assertEqual("line-Cycles" in traces, axis != "rays")
                self.assertEqual("Cycles" in self.text("#error [aria-live]"), axis == "rays")
                self.assertEqual(
                    traces.get("guide", {}).get("name"), {"flip": None, "smape": "slope −½"}.get(metric, "slope −1")
                )

    def test_points_near_the_floor_are_hollow(self):
        self.open()
        drawn = {trace["name"]: trace["symbol"] for trace in self.traces() if trace["uid"].startswith("line-")}
        hollow = 0
        for configuration in self.report["configurations"]:
            flags = [symbol.endswith("-open") for symbol in drawn[configuration["name"]]]
            self.assertEqual(flags, [p["near_floor"] for p in configuration["curve"]])
            hollow += sum(flags)
        self.assertGreater(hollow, 0)
        self.assertEqual(len({symbols[0] for symbols in drawn.values()}), len(drawn))

    def test_legend_hides_a_line_and_its_band_for_good(self):
        self.open()
        self.run_js("document.querySelector('.curves').scrollIntoView({block: 'center'})")
        before = self.count(".curves .scatterlayer .trace")
        self.one(".curves .legend .legendtoggle").click()
        self.until(lambda: self.count(".curves .scatterlayer .trace") == before - 2)
        Select(self.one("select[name=error]")).select_by_value("mse")
        hidden = "return document.querySelector('.curves')._fullData.filter(t => t.visible === 'legendonly').map(t => t.uid).sort()"
        self.assertEqual(self.run_js(hidden), ["band-equal", "line-equal"])

    def test_a_point_tells_its_numbers(self):
        self.open()
        self.run_js("document.querySelector('.curves').scrollIntoView({block: 'center'})")
        point = self.driver.find_elements(By.CSS_SELECTOR, ".curves .points path")[3]
        ActionChains(self.driver, duration=0).move_to_element(point).perform()
        self.until(lambda: self.count(".curves .hoverlayer .hovertext"))
        said = self.text(".curves .hoverlayer")
        self.assertIn("8 spp", said)
        self.assertRegex(said, r"relMSE 0\.0163 \[0\.0150, 0\.0175\]")

    def test_the_figure_is_saved_as_svg(self):
        self.open()
        self.run_js("document.querySelector('.curves').scrollIntoView({block: 'center'})")
        self.one(".curves .modebar-btn[data-title]").click()
        saved = self.folder / "veach-relmse-wall.svg"
        self.until(saved.exists)
        self.assertIn("second-moment", saved.read_text())

    # ---- the viewer

    def test_keys_flip_and_keep_the_view(self):
        self.open()
        names = [image["key"] for image in self.report["images"] if image["group"] == "image"]
        self.focus_viewer()
        self.assertEqual(self.canvas["image"], names[0])
        self.press("+", "+", "e", "e", "E")
        self.point_at(0.8, 0.3)
        ActionChains(self.driver, duration=50).click_and_hold().move_by_offset(-90, 60).release().perform()
        view = {key: value for key, value in self.canvas.items() if key != "image"}
        self.assertEqual((view["zoom"], view["exposure"]), ("2.2500", "0.5"))
        self.assertGreater(float(view["x"]), 0.51)
        self.assertLess(float(view["y"]), 0.49)
        flips = [
            ("2", 1),
            ("5", 4),
            (Keys.ARROW_RIGHT, 5),
            (Keys.ARROW_RIGHT, 0),
            (Keys.ARROW_LEFT, 5),
            ("9", 5),
            ("1", 0),
        ]
        for key, expected in flips:
            with self.subTest(key):
                self.press(key)
                now = self.canvas
                self.assertEqual(now.pop("image"), names[expected])
                self.assertEqual(now, view)
                self.assertEqual(
                    self.run_js(
                        "return [...document.querySelectorAll('.thumbs button')].findIndex(b => b.ariaPressed === 'true')"
                    ),
                    expected,
                )
        self.press("4")
        self.show("errors")
        now = self.canvas
        self.assertEqual(now.pop("image"), f"{names[3]}-error")
        self.assertEqual(now, view)
        self.focus_viewer()
        for key in ("0", Keys.HOME):
            self.press("+", "e", key)
            self.assertEqual(
                {key: self.canvas[key] for key in ("zoom", "x", "y", "exposure")},
                {"zoom": "1.0000", "x": "0.50000", "y": "0.50000", "exposure": "0"},
            )

    def test_keys_work_where_nothing_has_the_focus(self):
        self.open()
        self.press("3")
        self.assertEqual(self.canvas["image"], "reference")  # it cannot be seen yet
        self.run_js("document.querySelector('canvas.main').scrollIntoView({block: 'center'})")
        self.press("3")
        self.assertEqual(self.canvas["image"], "variance")

    def test_wheel_zooms_about_the_pointer_and_only_where_clicked(self):
        self.open()
        self.run_js("document.querySelector('canvas.main').scrollIntoView({block: 'center'})")
        told = self.point_at(0.7, 0.4)
        wheel = "const c = document.querySelector('canvas.main'), b = c.getBoundingClientRect(); c.dispatchEvent(new WheelEvent('wheel', {deltaY: -300, clientX: b.left + 0.7 * b.width, clientY: b.top + 0.4 * b.height, cancelable: true}))"
        self.run_js(wheel)
        self.assertEqual(self.canvas["zoom"], "1.0000")
        self.focus_viewer()
        self.run_js(wheel)
        self.assertGreater(float(self.canvas["zoom"]), 1.5)
        self.assertEqual(self.point_at(0.7, 0.4), told)

    def test_pixels_are_what_was_packed(self):
        """Radiance to the mantissa's precision, maps to theirs; and the screen shows its sRGB at the exposure."""
        self.open()
        self.focus_viewer()
        reference = report_sample.scene()
        for x, y in ((0.123, 0.456), (0.2, 0.62), (0.5, 0.9), (0.935, 0.1)):
            told = self.point_at(x, y)
            column, row, *values = map(float, re.findall(r"(?<=[xyRGB] )[\d.]+", told))
            with self.subTest(told):
                self.assertLess(abs(column - x * report_sample.WIDTH), 1.5)
                self.assertLess(abs(row - y * report_sample.HEIGHT), 1.5)
                exact = reference[int(row), int(column)]
                for value, truth in zip(values, exact):
                    self.assertLess(abs(value - truth), exact.max() / 256 + 0.005 * truth)
        self.press("E", "E")  # a stop darker
        self.assertEqual(self.canvas["exposure"], "-1")
        exact = reference[int(0.9 * report_sample.HEIGHT), int(0.05 * report_sample.WIDTH)]
        for shown, truth in zip(self.run_js(COLOUR, 0.0515, 0.9015), exact / 2):
            self.assertLess(abs(shown - 255 * (1.055 * truth ** (1 / 2.4) - 0.055)), 2)
        self.show("maps")
        told = self.point_at(0.935, 0.1)
        self.assertRegex(told, r"better|worse|undecided")
        self.assertEqual(self.count(".legend .key i"), 3)
        self.assertIn("none", self.point_at(0.5, 0.995))
        self.focus_viewer()
        self.press("4")
        self.assertRegex(self.text(".legend .scale"), r"0.*2\.00.*4\.00")
        told = self.point_at(0.2, 0.62)
        column, row, value = map(float, re.findall(r"[\d.]+", told))
        truth = (reference[int(row), int(column)] ** 2).mean() ** 0.5
        self.assertLess(abs(value - min(truth, 4)), 0.005 * value + 1e-4)
        self.show("errors")
        self.assertIn("no value", self.point_at(0.5, 0.004))
        self.assertTrue(self.run_js("return document.querySelector('.viewer input[type=range]').disabled"))
        self.show("allocation")
        self.assertRegex(self.point_at(0.5, 0.5), r"lobes [\d.]+ % +cosine 14\.9 % +light")

    def test_ways_are_a_pyramid(self):
        self.open()
        rows = self.run_js(
            """return [...document.querySelectorAll('.ways > div')].map(row => [...row.querySelectorAll('figcaption')].map(c => c.innerText))"""
        )
        self.assertEqual([len(row) for row in rows], [2, 3, 4])
        self.assertEqual([c.split("\n")[0] for c in rows[2]], ["camera alone", "2 + 1", "1 + 2", "to the film"])
        self.assertIn("11 %", rows[0][0])
        colours = self.run_js(
            """return [...document.querySelectorAll('.ways canvas')].map(c => c.getContext('2d').getImageData(24, 16, 1, 1).data[0])"""
        )
        self.assertEqual(set(colours), {188})  # sRGB of .5

    def test_everything_is_one_list(self):
        self.open()
        self.show("everything")
        self.assertEqual(self.count(".thumbs button"), len(self.report["images"]))
        self.focus_viewer()
        for image in self.report["images"]:
            self.assertEqual(self.canvas["image"], image["key"])
            self.press(Keys.ARROW_RIGHT)
        self.assertEqual(self.canvas["image"], "reference")

    def test_fingers_pinch_and_drag(self):
        self.open(width=390, touch=True)
        self.focus_viewer()
        self.driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")
        box = self.run_js("return document.querySelector('canvas.main').getBoundingClientRect().toJSON()")
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

        def touch(kind, *points):
            self.driver.execute_cdp_cmd(
                "Input.dispatchTouchEvent",
                {"type": kind, "touchPoints": [{"x": a, "y": b, "id": i} for i, (a, b) in enumerate(points)]},
            )

        touch("touchStart", (x - 30, y), (x + 30, y))
        for spread in (40, 50, 60, 75, 90):
            touch("touchMove", (x - spread, y), (x + spread, y))
            time.sleep(0.03)
        touch("touchEnd")
        zoomed = self.canvas
        self.assertGreater(float(zoomed["zoom"]), 2)
        touch("touchStart", (x, y))
        for by in (10, 20, 30, 40):
            touch("touchMove", (x + by, y + by))
            time.sleep(0.03)
        touch("touchEnd")
        moved = self.canvas
        self.assertLess(float(moved["x"]), float(zoomed["x"]) - 0.02)
        self.assertEqual(moved["zoom"], zoomed["zoom"])
        self.assertIn("x ", self.text(".pixel"))

    # ---- for everyone

    def test_names_for_those_who_do_not_see(self):
        self.open()
        nameless = "return [...document.querySelectorAll('button, select, input, canvas.main, .plot, table')].filter(e => !(e.ariaLabel || e.textContent.trim() && e.tagName === 'BUTTON' || e.closest('label'))).map(e => e.outerHTML.slice(0, 99))"
        self.assertEqual(self.run_js(nameless), [])
        self.assertEqual(self.run_js("return document.querySelectorAll('h1').length"), 1)
        self.focus_viewer()
        self.assertIn("reference", self.run_js("return document.activeElement.ariaLabel"))

    def test_prints_in_light_colours(self):
        self.open(scheme="dark")
        self.run_js("window.dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(self.run_js("return document.documentElement.dataset.theme"), "light")
        self.run_js("window.dispatchEvent(new Event('afterprint'))")
        self.assertEqual(self.run_js("return document.documentElement.dataset.theme"), "dark")
