#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""`adit run --view`: a real browser watches a run that goes on, beside a client that never reads.

Usage: live_run.py ADIT [PICTURES]. What is shown must grow and come back when the line was lost; at the end the page must
show the result. The files must be those of a run that nobody watches. PICTURES is a folder for screenshots.
"""

import json
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading

from chromium import Chromium
from viewing import foxglove_link, require
from websocket import WebSocket

SETTINGS = ["--set", "keyframe.delta_trans=0.3"]
SWEEPS = 240
MOST_MEMORY = 60e6  # bytes more than without a page
LIVE = "window.adit.liveShown"
ALL_THERE = "window.adit.cloud.drawn > 0 && window.adit.cloud.missing === 0 && window.adit.painter.isIdle"


class Running:
    """A running `adit run --view`, which leaves the browser its time; port and link are those it has printed."""

    def __init__(self, adit, recording, out, *options):
        self.process = subprocess.Popen(["nice", "-n", "15", str(adit), "run", str(recording), "-o", str(out), *SETTINGS,
                                         "--view", *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.said = []
        self.ended = threading.Event()  # the run, not the program
        for line in self.process.stderr:
            self.said.append(line)
            found = re.search(r"open +(http://\S+?:(\d+)/\S*)", line)
            if found:
                self.link, self.port = found.group(1), int(found.group(2))
            self.foxglove = foxglove_link(line)
            if self.foxglove if "--foxglove" in options else found:
                break
        else:
            sys.exit("adit run --view did not start:\n" + "".join(self.said))
        self.readers = [threading.Thread(target=self._read, args=(stream,))
                        for stream in (self.process.stdout, self.process.stderr)]
        for reader in self.readers:
            reader.start()

    def _read(self, stream):
        for line in stream:
            self.said.append(line)
            if line.startswith("Ctrl-C ends it"):
                self.ended.set()

    def end(self):
        """Ends it in good order; returns all that it has printed."""
        self.process.send_signal(signal.SIGTERM)
        code = self.process.wait(timeout=20)
        for reader in self.readers:
            reader.join()
        text = "".join(self.said)
        require(code == 0, f"adit run --view ended with exit code {code}", text)
        return text


def watch(page, running, pictures):
    """From the first sweeps to the result."""
    page.open(running.link)
    page.wait(f"{LIVE} && {LIVE}.progress.sweeps > 0 && window.adit.cloud.keyframes > 0", 60)
    require(page.evaluate("window.adit.sensor.visible"), "the sensor is not shown")
    first = page.evaluate(f"[{LIVE}.progress.sweeps, window.adit.layer.path.length, window.adit.cloud.drawn]")
    page.screenshot(pictures / "live_begin.png")

    # The line is lost: the page finds back by itself, and goes on.
    page.evaluate("window.adit.connection.socket.close()")
    page.wait(f"{LIVE}.progress.sweeps > {first[0] + 5} && window.adit.connection.isOpen", 60)
    page.wait(f"window.adit.layer.path.length > {first[1]} && window.adit.cloud.drawn > {first[2]}", 60)
    page.wait("document.getElementById('status').textContent.includes('sweeps')")
    page.wait("window.adit.graphShown.keyframes.id.length > 1", 60)
    page.screenshot(pictures / "live_later.png")
    check_time(page)
    seen = page.evaluate(f"[{LIVE}.progress.sweeps, window.adit.layer.path.length, window.adit.cloud.drawn]")
    grown = page.evaluate("document.getElementById('status').textContent")

    page.wait("window.adit.sceneShown.live !== true", 120)
    page.wait(ALL_THERE, 60)
    require("The run has ended" in page.evaluate("document.getElementById('notice').textContent"), "no end is announced")
    page.wait("/ of .* points$/.test(document.getElementById('status').textContent)")
    require(page.evaluate("window.adit.sceneShown.sweeps.time.length") == SWEEPS, "the result has other sweeps")
    require(page.box("live")[2] == 0, "a result has no newest time")
    require(page.evaluate(f"{BINS} === {SWEEPS}"), "the result has no plots")
    require(page.evaluate("window.adit.sceneShown.intensity"), "the result has no intensities")
    page.screenshot(pictures / "live_end.png")
    print(f"watched from {first} to {seen} (sweeps, poses, points); {grown}")


BINS = "window.adit.plots.curve('overlap').least.length"
SHOWN = "window.adit.timeLine.now"


def check_time(page):
    """The time line of the run grows; what is scrubbed back to stays, also when the line was lost, until one goes live."""
    page.wait(f"{SHOWN} === null && {BINS} > 10")
    require(page.evaluate("document.getElementById('live').getAttribute('aria-pressed')") == "true", "it is not live")
    page.wait("document.getElementById('plots').offsetHeight > 0")
    bins = page.evaluate(BINS)
    page.wait(f"{BINS} > {bins} + 2", 60)
    x, y, width, height = page.box("plots")
    page.click(x + 0.3 * width, y + height / 2)
    held, end = page.evaluate(f"[{SHOWN}, {LIVE}.seconds]")
    require(held is not None and 0 < held < end, "the time that was clicked is not shown", held, end)
    there = [f"new Float32Array({pose}.elements.slice(12, 15)).join()"
             for pose in (f"window.adit.layer.poseAt({held})", "window.adit.sensor.matrix")]
    require(page.evaluate(" === ".join(there)), "the sensor is not where it was then", *map(page.evaluate, there))
    require(page.evaluate("window.adit.cloud.sweep === null"), "the newest sweep is shown in the past")
    page.click_on("grow")
    hidden = "[...window.adit.cloud.held.values()].filter((one) => !one.points.visible).length"
    page.wait(f"{hidden} > 0", 60)
    require(page.evaluate(f"[...window.adit.cloud.held.values()].every((one) => one.points.visible === (one.time <= {SHOWN}))"),
            "other keyframes are shown than there were")

    # The run goes on, and the line is lost and comes back: the time stays, and nothing is missing of what has come since.
    bins, sweeps = page.evaluate(f"[{BINS}, {LIVE}.progress.sweeps]")
    page.evaluate("window.adit.connection.socket.close()")
    page.wait(f"window.adit.connection.isOpen && {LIVE}.progress.sweeps > {sweeps} + 5 && {BINS} > {bins} + 3", 60)
    require(page.evaluate(SHOWN) == held, "the time did not stay", page.evaluate(SHOWN), held)
    require(page.evaluate("document.getElementById('live').getAttribute('aria-pressed')") == "false", "it passes for live")
    known = page.evaluate("window.adit.plots.curve('overlap').least.filter((value) => value !== null).length")
    require(known >= page.evaluate(BINS) - 1, "the plot has holes", known, page.evaluate(BINS))  # one may be on its way

    require(page.evaluate("window.adit.sceneShown.intensity"), "points have no intensities")
    page.click_on("live")
    page.wait(f"{SHOWN} === null && {hidden} === 0")
    page.wait("window.adit.cloud.sweep !== null")
    page.click(x + 0.5 * width, y + height / 2)
    page.wait(f"{SHOWN} !== null && window.adit.cloud.sweep === null")
    page.key("KeyL", "l")
    page.wait(f"{SHOWN} === null && window.adit.cloud.sweep !== null")
    page.click_on("grow")
    # Played from the begin, it comes to the newest and goes on with it.
    page.evaluate("document.getElementById('speed').value = '64'")
    page.click_on("play")
    page.wait(f"!window.adit.timeLine.playing && {SHOWN} === null", 60)
    require(page.evaluate("window.adit.sceneShown.live === true"), "the run has ended before all was tried")


def never_reading(port):
    """Is connected from the beginning, asks, and takes nothing."""
    client = WebSocket(port, receive_buffer=4096)
    for _ in range(100):
        client.send('{"tiles": [0, 1, 2]}')
    return client


def check_recording(adit, page, recording, folder):
    """`adit view` of a recording maps it, shows the result, and leaves nothing."""
    with tempfile.TemporaryDirectory(dir=folder) as temporary:
        process = subprocess.Popen([str(adit), "view", str(recording)], env={**os.environ, "TMPDIR": temporary},
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        try:
            said = []
            for line in process.stderr:
                said.append(line)
                found = re.search(r"open +(http://\S+)", line)
                if found:
                    break
            require(found and "a folder that goes away" in said[0], "not said what happens", *said)
            page.open(found.group(1))
            page.wait("window.adit.sceneShown && window.adit.sceneShown.live !== true", 120)
            page.wait(ALL_THERE, 60)
            require(os.listdir(temporary), "nothing is made of it")
            process.send_signal(signal.SIGTERM)
            process.stderr.read()
            require(process.wait(timeout=20) == 0, "it ended otherwise", process.returncode)
        finally:
            process.kill()
        require(os.listdir(temporary) == [], "something is left", os.listdir(temporary))


def peak(out):
    return json.loads((out / "summary.json").read_text(encoding="utf-8"))["memory"]["resident_peak_bytes"]


def check_refusals(adit, recording, folder):
    """What cannot be served is said before the run begins."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        ran = subprocess.run([str(adit), "run", str(recording), "-o", str(folder / "none"), "--view", "--port", str(port)],
                             capture_output=True, text=True, check=False)
    require(ran.returncode == 2 and f"port {port}" in ran.stderr, "a port that is taken is not complained about", ran)
    require(not (folder / "none" / "summary.json").exists(), "the run has begun all the same")
    ran = subprocess.run([str(adit), "run", str(recording), "-o", str(folder / "none"), "--port", "0", "--listen", "0.0.0.0"],
                         capture_output=True, text=True, check=False)
    require(ran.returncode == 2 and "need --view" in ran.stderr, "an address without a page is not complained about", ran)


def main():
    adit = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else folder
        pictures.mkdir(parents=True, exist_ok=True)
        recording, alone, watched = folder / "room.mcap", folder / "alone", folder / "watched"
        subprocess.run([str(adit), "simulate", "room", "-o", str(recording), "--duration", str(SWEEPS / 10), "--trajectory",
                        "walk", "--quiet"], check=True)
        check_refusals(adit, recording, folder)
        browser = Chromium()
        try:
            page = browser.page()
            running = Running(adit, recording, watched)
            try:
                client = never_reading(running.port)
                watch(page, running, pictures)
                require(running.ended.wait(20), "the console does not say that the run has ended", *running.said)
                client.close()
                text = running.end()
            finally:
                running.process.kill()  # where the test has ended before it
            check_recording(adit, page, recording, folder)
            require(page.errors == [], "the console has errors", *page.errors)
        finally:
            browser.close()
        require("result is shown" in text, "not said what is served", text)
        subprocess.run([str(adit), "run", str(recording), "-o", str(alone), *SETTINGS, "--quiet"], check=True)
        names = sorted(file.name for file in alone.iterdir())
        require(names == sorted(file.name for file in watched.iterdir()), "there are other files", names)
        for name in names:
            if name != "summary.json":  # which has times
                require((alone / name).read_bytes() == (watched / name).read_bytes(), f"{name} is another where it is watched")
        more = peak(watched) - peak(alone)
        require(more < MOST_MEMORY, f"the page took {more} bytes")
        print(f"memory: {more / 1e6:.1f} MB more")
    print("live_run: grows, comes back, shows the result; the same bytes")


if __name__ == "__main__":
    main()
