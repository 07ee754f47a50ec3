# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""A headless Chromium, driven by its DevTools protocol."""

import base64
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request

from websocket import WebSocket

# Counts, in a screenshot and so as a user sees it, pixels within a tolerance of a colour; without a colour, those that
# differ from the first pixel's.
COUNT = """new Promise((done, fail) => {
  const image = new Image();
  image.onerror = fail;
  image.onload = () => {
    const canvas = document.createElement('canvas');
    canvas.width = image.width;
    canvas.height = image.height;
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const data = context.getImageData(0, 0, image.width, image.height).data;
    const wanted = COLOUR ?? [data[0], data[1], data[2]];
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      const near = [0, 1, 2].every((k) => Math.abs(data[i + k] - wanted[k]) <= TOLERANCE);
      count += near === (COLOUR !== null) ? 1 : 0;
    }
    done({ count, width: image.width, height: image.height, first: [data[0], data[1], data[2]] });
  };
  image.src = 'data:image/png;base64,PNG';
})"""


STATE = """(() => { const { painter, controls, cloud } = window.adit;
  return JSON.stringify({ still: painter.isStill, waiting: painter.waiting, moved: painter.moved, now: performance.now(),
    busy: controls.busy, pointers: controls.pointers?.size, keys: [...(controls.keys ?? [])], eye: controls.eye,
    missing: cloud?.missing, hidden: document.hidden, frames: painter.frames.slice(-5) }); })()"""


class Chromium:
    def __init__(self, width=1280, height=800):
        self.folder = tempfile.mkdtemp()
        program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
        if program is None:
            sys.exit("needs Chromium (Debian: chromium)")
        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--remote-debugging-port=0", f"--user-data-dir={self.folder}",
             "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-gpu-vsync",
             "--hide-scrollbars", "--disable-dev-shm-usage", "--no-first-run", "--disable-extensions",
             "--disable-background-networking",
             f"--window-size={width},{height}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        ready = pathlib.Path(self.folder) / "DevToolsActivePort"
        for _ in range(300):
            if ready.exists() and ready.read_text(encoding="ascii").count("\n") >= 1:
                break
            time.sleep(0.1)
        else:
            sys.exit("Chromium does not start")
        self.port = int(ready.read_text(encoding="ascii").split()[0])

    def page(self):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/json/list") as answer:
            target = next(one for one in json.load(answer) if one["type"] == "page")
        return Page(self.port, target["webSocketDebuggerUrl"].split(str(self.port), 1)[1])

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


class Page:
    def __init__(self, port, path):
        self.line = WebSocket(port, path, timeout=120)
        self.number = 0
        self.errors = []          # of the page and of its console
        self.network_errors = []  # what the browser itself says of connections that fail
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def call(self, method, **parameters):
        self.number += 1
        self.line.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self.line.receive()[1])
            if message.get("id") == self.number:
                if "error" in message:
                    raise RuntimeError(f"{method}: {message['error']}")
                return message["result"]
            self._note(message)

    def _note(self, message):
        parameters = message.get("params", {})
        if message.get("method") == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(parameters["exceptionDetails"]))
        elif message.get("method") == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "assert", "warning"):
            self.errors.append(json.dumps(parameters["args"]))
        elif message.get("method") == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            entry = parameters["entry"]
            of_network = entry["source"] == "network" or "WebSocket" in entry["text"]
            (self.network_errors if of_network else self.errors).append(json.dumps(entry))

    def evaluate(self, expression):
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression[:200]}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait(self, expression, seconds=30):
        """Until the expression is true; returns its value, or ends the test."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            value = self.evaluate(f"(() => {{ try {{ return {expression}; }} catch (e) {{ return null; }} }})()")
            if value:
                return value
            time.sleep(0.05)
        sys.exit(f"FAILED: never came true within {seconds} s: {expression}\nstatus: "
                 f"{self.evaluate('document.getElementById(`status`)?.textContent')}\nerrors: {self.errors}\n"
                 f"link: {self.evaluate('location.href')}\nstate: {self.evaluate(STATE)}")

    def open(self, url):
        self.call("Page.navigate", url="about:blank")
        self.call("Page.navigate", url=url)
        self.wait("document.readyState === 'complete' && location.href !== 'about:blank'")

    def screenshot(self, file=None):
        png = self.call("Page.captureScreenshot", format="png")["data"]
        if file:
            pathlib.Path(file).write_bytes(base64.b64decode(png))
        return png

    def count(self, colour=None, tolerance=6, png=None):
        """Pixels of that colour on the screen, or in a PNG file; None: those unlike the upper left corner."""
        expression = COUNT.replace("COLOUR", json.dumps(colour)).replace("TOLERANCE", str(tolerance))
        data = base64.b64encode(png).decode() if png else self.screenshot()
        return self.evaluate(expression.replace("PNG", data))

    def click(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)

    def box(self, identifier):
        """left, top, width and height of the element, scrolled to where it is seen."""
        return self.evaluate(f"""(() => {{
            const element = document.getElementById('{identifier}');
            element.scrollIntoView({{ block: 'nearest' }});
            const box = element.getBoundingClientRect();
            return [box.x, box.y, box.width, box.height];
        }})()""")

    def click_on(self, identifier):
        """The middle of the element, wherever it is now."""
        x, y, width, height = self.box(identifier)
        self.click(x + width / 2, y + height / 2)

    def drag(self, start, end, steps=5):
        def mouse(kind, share, buttons=1):
            x, y = (a + (b - a) * share for a, b in zip(start, end))
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=buttons, clickCount=1)

        mouse("mousePressed", 0)
        for i in range(1, steps + 1):
            mouse("mouseMoved", i / steps)
        mouse("mouseReleased", 1, buttons=0)

    def touch(self, *path):
        """One finger along these places."""
        for i, (x, y) in enumerate(path):
            self.call("Input.dispatchTouchEvent", type="touchMove" if i else "touchStart", touchPoints=[{"x": x, "y": y}])
        self.call("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def key(self, code, key):
        number = ord(key.upper()) if len(key) == 1 else 27  # Escape
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, code=code, key=key, windowsVirtualKeyCode=number)
