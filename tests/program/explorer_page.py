"""The explorer's page in headless Chromium, for explorer_test.py."""

import contextlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
import urllib.parse

from support import REPOSITORY, DirectoryTest

BUILD = os.path.join(REPOSITORY, "analysis", "explorer", "build.sh")

# For scripts: an element, and replacing the text of a field.
AT = "const at = (id) => document.getElementById(id);"
TYPE = f"""{AT} const type = (id, text) => {{
  at(id).closest('details')?.setAttribute('open', '');
  at(id).value = text;
  at(id)[at(id).tagName === 'SELECT' ? 'onchange' : 'oninput']();
}};"""


def skip_unless_installed():
    """Exits with code 77, saying why, if a package is missing."""
    sys.dont_write_bytecode = True
    with open(BUILD, encoding="utf-8") as file:
        needed = re.search(r"^packages=\((.*)\)", file.read(), re.MULTILINE)[1].split()
    needed += ["chromium", "chromium-driver", "python3-selenium"]
    installed = subprocess.run(["dpkg-query", "-W", "-f", "${Package} ${db:Status-Status}\n", *needed],
                               capture_output=True, text=True, check=False).stdout if shutil.which("dpkg-query") else ""
    missing = [package for package in needed if f"{package} installed" not in installed]
    if missing:
        print(f"skipped: the tests of the explorer, which need the packages {' '.join(missing)}")
        sys.exit(77)


class PageTest(DirectoryTest):
    """Tests of the page in a browser, and what a person does with it."""

    loaded = None  # the file that the browser shows

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service
        cls.page = cls.path("explorer.html")
        subprocess.run([BUILD, "-o", cls.page], check=True, capture_output=True, timeout=500)
        options = webdriver.ChromeOptions()
        options.binary_location = shutil.which("chromium")
        for argument in ("--headless=new", "--no-sandbox", "--force-prefers-reduced-motion", "--window-size=1500,1400",
                         f"--user-data-dir={cls.path('chromium')}"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        cls.browser = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
        cls.addClassCleanup(cls.browser.quit)
        cls.browser.set_script_timeout(300)

    def setUp(self):
        self.browser.get_log("browser")
        self.browser.get_log("performance")

    def tearDown(self):
        severe = [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] != "INFO"]
        self.assertEqual(severe, [], "messages on the console")
        requests = [json.loads(entry["message"])["message"] for entry in self.browser.get_log("performance")]
        addresses = [request["params"]["request"]["url"] for request in requests
                     if request["method"] == "Network.requestWillBeSent"]
        self.assertEqual([url for url in addresses if re.match("(http|ws|ftp)s?:", url)], [])

    def open(self, job=(), design=(), pictures=True, **more):
        """Shows a job and a design by the address of the page, which is loaded once; waits for readouts and pictures,
        if asked: without them, readouts can still be those of an earlier design."""
        address = self.address(job, design, **more)
        if self.loaded != self.page:
            self.load(address, pictures=pictures)
        self.script("history.replaceState(null, '', '#' + arguments[0]); "
                    "dispatchEvent(new HashChangeEvent('hashchange'))", address)
        if pictures:
            self.wait_for_pictures()

    def load(self, address="", page=None, pictures=True):
        """Loads the page, or another; waits for its readouts and, if asked, its pictures."""
        self.browser.get("about:blank")
        self.browser.get(f"file://{page or self.page}#{address}")
        type(self).loaded = page or self.page
        self.wait(lambda: self.text("readout.status"))
        if pictures:
            self.wait_for_pictures()

    @staticmethod
    def address(job=(), design=(), **more):
        """The part of an address that describes a job, a design and what else is shown."""
        parameters = {**dict(job), **dict(design), **more}
        if job and not design:
            parameters.update(r1="0.51", r3="0.58", r2="0.91")
        return urllib.parse.urlencode(parameters)

    @contextlib.contextmanager
    def window(self, width, height, scheme="light", mobile=False):
        """A window of a size and colour scheme; a mobile one is touched."""
        command = self.browser.execute_cdp_cmd
        command("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile})
        command("Emulation.setTouchEmulationEnabled", {"enabled": mobile})
        command("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
        try:
            yield
        finally:
            command("Emulation.clearDeviceMetricsOverride", {})
            command("Emulation.setTouchEmulationEnabled", {"enabled": False})
            command("Emulation.setEmulatedMedia", {"features": []})

    def script(self, text, *arguments):
        return self.browser.execute_script(text, *arguments)

    def wait(self, condition, seconds=60):
        """Waits for a condition; returns its value."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if found := condition():
                return found
            time.sleep(0.02)
        return self.fail(f"waited {seconds} s; notice: {self.text('notice')}")

    def wait_for_pictures(self):
        """Waits until everything that was asked for is on the page."""
        self.wait(lambda: self.script("return document.querySelector('main').ariaBusy") == "false")

    @contextlib.contextmanager
    def another_swing(self):
        """Waits after a change, on a page that shows the swing of its design, until the readouts are those of another
        one. They come before pictures and searches, for which it waits only if the swing stays the same."""
        before = self.text("readout.peak-axle-load")
        yield
        self.wait(lambda: self.script(
            "const load = document.getElementById('readout.peak-axle-load'); "
            "return (load && load.textContent !== arguments[0]) || document.querySelector('main').ariaBusy === 'false'",
            before))

    def find(self, name):
        return self.browser.find_element("id", name)

    def text(self, name):
        return self.script("return document.getElementById(arguments[0])?.textContent", name)

    def number(self, field):
        return float(self.text(f"readout.{field}").replace("–", "nan"))

    def type(self, name, text):
        """Replaces the text of a field."""
        self.script(f"{TYPE} type(...arguments)", name, text)

    def picture(self, name):
        return self.script("return document.getElementById(arguments[0]).toDataURL()", name)

    def pictures(self):
        names = ["plane.0", "plane.1", "plane.2", "machine", "flight", "plots"]
        return {name: self.picture(name) for name in names}

    def design(self):
        return {axis: float(self.find(f"design.{axis}").get_property("value")) for axis in ("r1", "r3", "r2")}

    def copied_job(self):
        """The text of the job file that the page offers."""
        self.find("copy").click()
        text = self.find("jobtext").get_property("value")
        self.script("document.getElementById('dialog').close()")
        return text

    def open_files(self, files):
        """Opens job files, pairs of name and text, one after the other, as if they were chosen. Returns the notices
        when the page has taken or refused them."""
        return self.browser.execute_async_script(f"{AT} const [files, done] = arguments;" + """(async () => {
            const notices = [];
            for (const [name, text] of files) {
              const chosen = new DataTransfer(), end = performance.now() + 60000;
              chosen.items.add(new File([text], name));
              at('file').files = chosen.files;
              at('file').onchange();
              const isKnown = () => at('preset').value === name || at('notice').textContent.startsWith(`${name}: `);
              while (!isKnown() && performance.now() < end) await new Promise((resolve) => setTimeout(resolve));
              notices.push(isKnown() ? at('notice').textContent : `${name} was neither taken nor refused`);
            }
            done(notices);
          })();""", files)

    def open_file(self, name, text):
        """Writes a job file and opens it on the page. Returns the notice."""
        self.write(name, text)
        return self.open_files([(name, text)])[0]

    def type_mistake(self, name, text):
        """Replaces the text of a field, and restores it. Returns the messages in between, and whether the first picture
        and the headline stay."""
        return self.browser.execute_async_script(f"{TYPE} const [id, text, done] = arguments;" + """(async () => {
            const look = async () => {
              do await new Promise(requestAnimationFrame);
              while (document.querySelector('main').ariaBusy !== 'false');
              return [at('plane.0').toDataURL(), at('headline').textContent];
            };
            const before = await look(), old = at(id).tagName === 'SELECT' ? at(id).value : '';
            type(id, text);
            const after = await look(), stays = after.map((now, i) => now === before[i]);
            const messages = [...document.querySelectorAll('.message')].map((node) => node.textContent);
            type(id, old);
            done([messages.filter((message) => message), stays]);
          })();""", name, text)

    def refused(self, name, *options):
        """What the program says when it refuses a job. A trace, which takes a third of the time of a sweep, reads the
        same job, but not all options."""
        done = self.run_program("trace", name, *options, "--r1", "0.51", "--r2", "0.91", "--r3", "0.58", code=None)
        if done.returncode != 2 or re.search(r"one scene|\br1\b|unknown option", done.stderr):
            done = self.run_program("sweep", name, *options, code=2)
        return done.stderr.strip()

    def refusal(self, name):
        """The message with which the program refuses a job file, without the name of the file."""
        return self.refused(name).removeprefix("trebsweep: ").removeprefix(f"job file {name}: ")

    def traced(self, *arguments, design):
        """The last row of `trebsweep trace`, as {column: number}."""
        lengths = [word for axis, value in design.items() for word in (f"--{axis}", str(value))]
        done = self.run_program("trace", *arguments, *lengths, "--solver.tolerance", "1e-11")
        header, *rows = [line.split() for line in done.stdout.splitlines() if not line.startswith("#")]
        return dict(zip(header, map(float, rows[-1]))), done

    def save_picture(self, name):
        path = os.path.join(os.environ.get("TREBSWEEP_PICTURES", self.directory), name)
        self.browser.save_screenshot(path)
        with open(path, "rb") as file:
            self.assertTrue(file.read().startswith(b"\x89PNG"))
