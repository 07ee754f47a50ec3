#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""The page of `adit view` in a real browser, with the hands of a user.

Usage: in_chromium.py ADIT WRITE_VIEW_MAP [PICTURES]. Scenes whose pixels and coordinates are known are looked at, picked,
scrubbed, edited, and left without a server for a while. PICTURES is a folder for screenshots.
"""

import json
import math
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import time

from chromium import Chromium
from page_graph import check_graph, check_layers, check_overlay, check_proposal, check_truth, click_loop
from page_hands import ALL_THERE, DARK, GREEN, HALF_FIELD, ORANGE, WHITE, facts, near, only_canvas, place
from viewing import Viewing, require, square, write_ply


def write_run(write_map, out):
    """The folder of a run of 10 s, of which little is known."""
    out.mkdir()
    subprocess.run([write_map, out / "map.adit"], check=True)
    weak = ",translation1_localizability,translation1_axis_x,translation1_axis_y,translation1_axis_z"
    rows = [f"{1_700_000_000 + i / 20:.2f},{0.1 if i == 120 else 0.9},{0.02 + i / 1e5},{'none,0,0,1' if i == 40 else ',,,'}"
            for i in range(201)]
    (out / "sweeps.csv").write_text("\n".join(["stamp_s,overlap,residual_rms_m" + weak, *rows, ""]), encoding="ascii")
    stretch = {"state": "doubtful", "begin_s": 5.5, "end_s": 6.5, "text": "a long corridor"}
    (out / "summary.json").write_text(json.dumps({"verdict": {"state": "doubtful", "stretches": [stretch]}}), encoding="ascii")


def check_cloud(page, link):
    """A square of 10 m from 20 m above, and a point alone above it."""
    above = f"eye=0,0,0,20,{-math.pi / 2:.5f},1.5707&shading=0"
    page.open(f"{link}#{above}")
    page.wait(ALL_THERE)
    height = page.evaluate("innerHeight")
    edge = 10.0 / (2 * 20.0 * math.tan(HALF_FIELD)) * height
    whole = only_canvas(page, page.count)
    require(near(whole["count"], edge * edge, 0.03), "the square's pixels", whole, edge * edge)
    require(whole["first"] == WHITE, "the page is not white", whole)
    low = only_canvas(page, lambda: page.count([0x3b, 0x3f, 0x8f]))
    require(near(low["count"], edge * edge, 0.03), "what is low has another colour", low)

    page.evaluate(f"location.hash = '{above}&box=0,-6,-1,6,6,5'")
    page.wait(f"window.adit.state.box && {ALL_THERE}")
    half = only_canvas(page, page.count)
    require(near(half["count"], edge * edge / 2, 0.03), "the clipping box cuts elsewhere", half, edge * edge / 2)
    page.evaluate(f"location.hash = '{above}'")
    page.wait(f"!window.adit.state.box && {ALL_THERE}")

    check_scale(page, 0, 0, 0)
    require("north" not in page.evaluate("document.getElementById('marks').ariaLabel"), "north of a cloud that is nowhere")
    told = under_mouse(page, *place(page, 3, 2, 4))
    require(list(told) == ["x, y, z"] and math.dist(told["x, y, z"], (3, 2, 4)) < 0.002, "another place is under the mouse", told)
    page.click(*place(page, 3, 2, 4))
    told = facts(page)
    found = [float(number) for number in re.findall(r"-?\d+\.\d+", told.get("x, y, z", ""))]
    require(told[""] == "point" and len(found) == 3 and math.dist(found, (3, 2, 4)) < 0.002, "another point was picked", told)

    # A link that is entered stands, also in the moment in which the page writes its own.
    page.evaluate("""(() => {
        window.adit.above();
        const until = performance.now() + 400;
        while (performance.now() < until);
        location.hash = 'shading=0&eye=0,0,0,20,-0.9,0.7';
    })()""")
    page.wait(f"Math.abs(window.adit.controls.eye.pitch - 0.7) < 1e-3 && {ALL_THERE}")

    # From the upper point to one of the square, whose points are 0.02 m apart.
    page.evaluate("location.hash = 'shading=0&eye=0,0,0,20,-0.9,0.6'")
    page.wait(f"Math.abs(window.adit.controls.eye.pitch - 0.6) < 1e-3 && {ALL_THERE}")
    page.key("KeyM", "m")
    page.click(*place(page, 3, 2, 4))
    page.click(*place(page, 2.01, -1.99, 0))
    told = facts(page)
    require(re.match(r"[\d.]+ m", told[""]) and abs(float(told["height"].split()[0]) + 4) < 0.003 and
            abs(float(told[""].split()[0]) - math.dist((3, 2, 4), (2.01, -1.99, 0))) < 0.15, "measured otherwise", told)
    page.key("Escape", "Escape")

    # A link has the view: turned by hand, then opened anew.
    page.drag((800, 500), (900, 540))
    page.wait("window.adit.painter.isIdle && location.hash.includes('eye=')")
    page.wait("Math.abs(Number(location.hash.match(/eye=([^&]*)/)[1].split(',')[4]) - window.adit.controls.eye.yaw) < 1e-3")
    link_now, eye = page.evaluate("location.href"), page.evaluate("JSON.stringify(window.adit.controls.eye)")
    require("-0.9," not in link_now, "nothing was turned", link_now)
    page.open(link_now)
    page.wait(ALL_THERE)
    again = page.evaluate("JSON.stringify(window.adit.controls.eye)")
    numbers = [[float(n) for n in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", one)] for one in (eye, again)]
    require(all(abs(a - b) < 2e-3 for a, b in zip(*numbers)), "the link shows another view", eye, again)
    for colour in ("intensity", "height"):
        page.evaluate(f"""(() => {{
            const list = document.getElementById('colour');
            list.value = '{colour}';
            list.dispatchEvent(new Event('change'));
        }})()""")
        page.wait(f"location.hash.includes('colour=intensity') === {'true' if colour == 'intensity' else 'false'}")


def under_mouse(page, x, y):
    """What is told of the place under the mouse, by name: numbers."""
    page.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    page.wait("!document.getElementById('under').hidden")
    page.wait("window.adit.places.asked.size === 0")  # what the server says of it has come
    terms = page.evaluate("[...document.querySelectorAll('#under dt')].map((t) => [t.textContent, t.nextSibling.textContent])")
    return {name: [float(number) for number in re.findall(r"-?\d+\.\d+", value)] for name, value in terms}


def check_scale(page, x, y, z):
    """The bar is as long as what it says there, which is what is looked at, and of a round length."""
    marks = page.evaluate("window.adit.marks.shown")
    (ax, ay), (bx, by) = place(page, x, y, z), place(page, x + 1, y, z)
    require(near(math.hypot(bx - ax, by - ay), marks["pixels"] / marks["metres"], 0.002), "another scale", ax, ay, bx, by, marks)
    require(marks["metres"] / 10 ** math.floor(math.log10(marks["metres"]) + 1e-9) in (1, 2, 5), "no round length", marks)
    drawn = page.evaluate("""(() => {
        const canvas = document.getElementById('marks'), ratio = canvas.width / canvas.clientWidth;
        const row = canvas.getContext('2d').getImageData(0, 47 * ratio, canvas.width, 1).data;
        let dark = 0;
        for (let x = 66 * ratio; x < canvas.width; ++x) dark += row[4 * x] < 100 && row[4 * x + 3] > 200 ? 1 : 0;
        return dark / ratio;
    })()""")
    require(abs(drawn - marks["pixels"]) < 4, "the bar is drawn otherwise", drawn, marks)


def check_world(page, link):
    """The map's x axis points 30 degrees north of east."""
    page.open(f"{link}#eye=20,0,2,20,{-math.pi / 2:.5f},1.5707&layers=")
    page.wait(ALL_THERE)
    check_scale(page, 20, 0, 2)
    require(page.evaluate("document.getElementById('marks').ariaLabel").endswith("north is 30° clockwise from up"), "no north")
    told = under_mouse(page, *place(page, 20, 0, 2))
    x, y, z = told["x, y, z"]
    require(math.dist((x, y, z), (20, 0, 2)) < 0.002, "another place is under the mouse", told)
    latitude, longitude = told["lat, lon"]
    sine = math.sin(math.radians(48))
    across = 6378137 / math.sqrt(1 - 0.00669438 * sine ** 2)
    along = across * (1 - 0.00669438) / (1 - 0.00669438 * sine ** 2)
    north = math.radians(latitude - 48) * (along + 500)
    east = math.radians(longitude - 11.5) * (across + 500) * math.cos(math.radians(48))
    turned = (x * math.cos(math.pi / 6) - y * math.sin(math.pi / 6), x * math.sin(math.pi / 6) + y * math.cos(math.pi / 6))
    require(math.dist((east, north), turned) < 0.003, "it is elsewhere on the Earth", told, east, north, turned)
    require(abs(told["height"][0] - 500 - z) < 0.002 and "UTM 32N" in told, "no height, no UTM", told)
    page.click(*place(page, 20, 0, 2))
    page.wait("document.getElementById('facts').textContent.includes('UTM 32N')")


def check_picture(page, link, pictures):
    """The PNG file has what is on the canvas, and below it the scale bar and what colours mean."""
    page.call("Page.setDownloadBehavior", behavior="allow", downloadPath=str(pictures))
    page.open(f"{link}#eye=24,0,0,45,{-math.pi / 2:.5f},1.5707&layers=loops,keyframes")
    page.wait(ALL_THERE)
    canvas = only_canvas(page, lambda: page.count(GREEN))
    file = pictures / "out.png"
    file.unlink(missing_ok=True)
    page.click_on("picture")
    until = time.monotonic() + 10
    while not file.exists() and time.monotonic() < until:
        time.sleep(0.05)
    require(file.exists(), "no picture was saved", list(pictures.iterdir()))
    saved = page.count(GREEN, png=file.read_bytes())
    height = page.evaluate("document.getElementById('view').clientHeight")
    require(saved["width"] == canvas["width"] and saved["height"] >= height + 64, "another size", saved, height)
    swatch = saved["count"] - canvas["count"]
    require(near(swatch, 121, 0.2), "the loop, or its colour in the legend, is missing", saved, canvas)
    bar = page.count([0, 0, 0], png=file.read_bytes())["count"]
    require(bar > 2 * page.evaluate("window.adit.marks.shown.pixels"), "no scale bar", bar)


def check_export(page, link, adit, folder):
    """What the command in the page writes is what is in the box: the second keyframe's wall, and its point alone."""
    page.open(f"{link}#box=5.95,-1,-5,14.05,6,5&moving=0&grow=1&time=3")
    page.wait(ALL_THERE)
    page.key("KeyX", "x")
    command = facts(page)["command"]
    require("--without-moving" in command and "--until 1700000003.000000000" in command, "another command", command)
    page.call("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
    page.click_on("act-copy")
    page.wait("document.getElementById('notice').textContent === 'The command is copied.'")
    require(page.evaluate("navigator.clipboard.readText()") == command, "another text was copied")
    words = shlex.split(command)
    require(words[0] == "adit", "another program", words)
    done = subprocess.run([adit, *words[1:]], cwd=folder, capture_output=True, text=True, check=False)
    require(done.returncode == 0, "the command fails", command, done.stderr)
    head = (folder / "cloud.ply").read_bytes()[:500]
    require(re.search(rb"element vertex +3201\n", head), "other points were exported", command, head)

    page.open(f"{link}#box=-4,1,-5,4,7,5,20")  # a box that is turned, with a corner at x below 0, is a polygon
    page.wait(ALL_THERE)
    page.key("KeyX", "x")
    command = facts(page)["command"].replace("&& adit ", f"&& {shlex.quote(str(adit))} ")
    done = subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True, check=False)
    head = (folder / "cloud.ply").read_bytes()[:500]
    count = int(re.search(rb"element vertex +(\d+)", head).group(1))
    require(done.returncode == 0 and 1000 < count < 3201, "the command of a turned box fails", command, done.stderr, count)


def check_keyframes(page, link):
    """Four walls are of the first session, two of the second; they are equal, seen from their side."""
    page.open(f"{link}#eye=25,4,0.5,45,{-math.pi / 2:.5f},0&layers=keyframes&colour=session&shading=0&size=1")
    page.wait(ALL_THERE)
    blue, orange = (only_canvas(page, lambda c=colour: page.count(c))["count"] for colour in ([0, 0x72, 0xb2], ORANGE))
    require(blue > 2000 and near(blue, 2 * orange, 0.05), "sessions have other colours", blue, orange)
    require(page.evaluate("document.getElementById('key').textContent").split() == ["1", "2"], "sessions have no legend")
    require(page.evaluate("document.getElementById('scale').hidden"), "a ramp is told of sessions")
    page.evaluate("location.hash = location.hash.replace('session', 'moving')")
    page.wait(f"window.adit.state.colour === 'moving' && {ALL_THERE}")
    blue = only_canvas(page, lambda: page.count([0, 0x72, 0xb2]))["count"]
    require(near(blue, 3 * orange, 0.05), "what stays has another colour", blue, orange)

    # A keyframe's points alone, also by the link, until what is told of it is closed.
    page.click(*place(page, 20, 0, 0))
    page.click_on("act-its-points-alone")
    page.wait("location.hash.includes('only=2') && window.adit.painter.isIdle")
    page.open(page.evaluate("location.href"))
    page.wait(ALL_THERE)
    require(facts(page)[""] == "keyframe 2", "the link tells of another", facts(page))
    alone = only_canvas(page, lambda: page.count([0, 0x72, 0xb2]))["count"]
    require(near(alone, orange / 2, 0.1), "other points are shown", alone, orange)
    require(page.evaluate("!window.adit.pointAt(...%s, 12)" % json.dumps(place(page, 40, 4, 0.5))), "what is hidden is picked")
    page.click_on("close")
    page.wait("!location.hash.includes('only') && window.adit.painter.isIdle")
    require(only_canvas(page, lambda: page.count([0, 0x72, 0xb2]))["count"] > 0.95 * blue, "the others are not back")


def check_section(page, link):
    """Along a line of 10 m of the square: a plank half a metre thick, somewhat longer than it."""
    above = f"eye=0,0,0,20,{-math.pi / 2:.5f},1.5707&shading=0"
    page.open(f"{link}#{above}")
    page.wait(ALL_THERE)
    page.key("KeyC", "c")
    page.click(*place(page, -4, -3, 0))
    page.click(*place(page, 4, 3, 0))
    page.wait("location.hash.includes('box=') && Math.abs(window.adit.controls.eye.pitch) < 1e-6")
    box = page.evaluate("window.adit.state.box")
    require(len(box) == 7 and abs(box[6] - math.degrees(math.atan2(3, 4))) < 0.5, "turned otherwise", box)
    page.evaluate(f"location.hash = '{above}&box={','.join(map(str, box))}'")
    page.wait(f"Math.abs(window.adit.controls.eye.pitch - 1.5707) < 1e-3 && {ALL_THERE}")
    metre = page.evaluate("innerHeight") / (2 * 20.0 * math.tan(HALF_FIELD))
    seen = only_canvas(page, page.count)["count"]
    require(near(seen, 11.0 * 0.5 * metre * metre, 0.1), "another section", seen, 5.5 * metre * metre)
    require(page.evaluate("!window.adit.pointAt(...%s, 3)" % json.dumps(place(page, 3, -3, 0))), "what is cut off is picked")


def check_dark(page):
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    page.wait("window.adit.painter.isIdle")
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    dark = only_canvas(page, lambda: page.count(DARK, 1))
    require(dark["first"] == DARK and dark["count"] > 100_000, "not dark", dark)
    page.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "light"}])


def check_time(page, link):
    page.open(f"{link}#layers=trajectory")
    page.wait(ALL_THERE)
    require(only_canvas(page, lambda: page.count(ORANGE))["count"] == 0, "a path where keyframes are 10 m apart")
    page.click_on("time")
    page.wait("Math.abs(window.adit.timeLine.now - 5) < 0.2")
    require(page.evaluate("document.getElementById('now').textContent").endswith("/ 0:10.0"), "another time is told")
    page.wait("window.adit.sensor.visible")
    at = page.evaluate("window.adit.sensor.matrix.elements[12] + window.adit.cloud.origin.x")
    require(min(abs(at - 20), abs(at - 30)) < 1, "the sensor is elsewhere", at)
    page.wait("location.hash.includes('time=')")
    page.click_on("grow")
    page.wait("location.hash.includes('grow=1') && window.adit.cloud.look.get('until') < 36000")
    page.click_on("play")
    page.wait("window.adit.timeLine.now > 6")
    page.wait("!window.adit.timeLine.playing && window.adit.timeLine.now >= 9.99", 15)


def check_plots(page, link):
    """Of the run, in whose second 6 overlaps drop to 0.1 and it does not vouch for itself."""
    page.open(f"{link}#layers=trajectory&plots=overlap")
    page.wait(ALL_THERE)
    offered = page.evaluate("[...document.querySelectorAll('#plotted input')].map((box) => [box.id, box.checked])")
    require(offered == [["plot-overlap", True], ["plot-rms", False]], "other plots are offered", offered)
    x, y, width, height = page.box("plots")
    page.click(x + 0.2 * width, y + height / 2)
    page.wait("Math.abs(window.adit.timeLine.now - 2) < 0.1 && window.adit.sensor.visible")
    page.drag((x + 0.3 * width, y + height / 2), (x + 0.602 * width, y + height / 2))
    page.wait("Math.abs(window.adit.timeLine.now - 6.02) < 0.05 && location.hash.includes('time=6.')")
    told = page.evaluate("window.adit.plots.valueAt(window.adit.plots.curve('overlap'), window.adit.timeLine.now)")
    require(told == "0.1", "another overlap is told", told)
    # The dip is drawn, and nothing but the mark of the time stands where there is none.
    lowest = page.evaluate("""(() => {
        const canvas = document.getElementById('plots'), context = canvas.getContext('2d');
        return [0.4, 0.6].map((share) => {
          const data = context.getImageData(share * canvas.width - 5, 0, 11, canvas.height).data;
          let lowest = 0;
          for (let i = 0; i < data.length; i += 4) {
            if (data[i] < 40 && data[i + 1] > 90 && data[i + 2] > 150 && data[i + 3] > 60) lowest = Math.floor(i / 44);
          }
          return lowest / canvas.height;
        });
    })()""")
    require(0.3 < lowest[0] < 0.6 and lowest[1] > 0.8, "the dip is drawn elsewhere", lowest)
    page.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + 0.6 * width, y=y + height / 2)
    require(page.evaluate("document.getElementById('plots').title") == "a long corridor", "the stretch is not told")
    page.click_on("plot-rms")
    page.wait("location.hash.includes('plots=overlap,rms')")
    require(page.box("plots")[3] > 1.5 * height, "no second plot", page.box("plots"), height)


def check_restart(page, adit, viewing, what):
    """The server goes and comes; the page waits for it, keeps its points and can edit again."""
    page.open(f"{viewing.link}#eye=24,0,0,45,{-math.pi / 2:.5f},1.5707&layers=loops,keyframes")
    page.wait(ALL_THERE)
    text = viewing.end()
    page.wait("document.getElementById('status').textContent.startsWith('no connection')")
    again = Viewing(adit, what, "--edit", port=viewing.port)
    page.wait(f"document.getElementById('status').textContent.includes('points') && {ALL_THERE}")
    click_loop(page, "accepted")
    page.click_on("act-revoke")
    page.wait("window.adit.graphShown.loops[0].verdict === 'revoked'")
    page.click_on("act-restore")
    page.wait("window.adit.graphShown.loops[0].verdict === 'accepted'")
    return again, text


def check_phone(page, link, pictures):
    page.call("Emulation.setDeviceMetricsOverride", width=390, height=844, deviceScaleFactor=2, mobile=True)
    page.call("Emulation.setTouchEmulationEnabled", enabled=True)
    page.open(f"{link}#eye=24,4,0,45,{-math.pi / 2:.5f},0.5")
    page.wait(ALL_THERE)
    require(page.evaluate("document.scrollingElement.scrollWidth <= 390"), "wider than the phone")
    require(not page.evaluate("document.getElementById('panel').open"), "the panel hides the map")
    for name in ("plots", "play", "time", "now", "speed"):
        x, y, width, height = page.box(name)
        require(x >= 0 and x + width <= 390 and y + height <= 844, f"{name} is beyond the edge", x, y, width, height)
    drawn = only_canvas(page, page.count)
    require(drawn["count"] > 20_000 and drawn["width"] == 780, "nothing is seen on a phone", drawn)
    page.screenshot(pictures / "phone.png")
    yaw = page.evaluate("window.adit.controls.eye.yaw")
    page.touch((200, 400), (230, 400), (260, 405), (290, 410))
    require(abs(page.evaluate("window.adit.controls.eye.yaw") - yaw) > 0.2, "a finger turns nothing")
    page.wait(ALL_THERE)
    page.evaluate(f"location.hash = 'eye=20,0,0,45,{-math.pi / 2:.5f},1.5'")
    page.wait(f"Math.abs(window.adit.controls.eye.pitch - 1.5) < 1e-3 && {ALL_THERE}")
    page.touch(tuple(place(page, 20, 0, 0)))
    page.wait("!document.getElementById('told').hidden")
    require(facts(page)[""].startswith("keyframe 2"), "a finger picks something else", facts(page))


def main():
    adit, write_map = (pathlib.Path(name).absolute() for name in sys.argv[1:3])
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        pictures = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else folder
        pictures.mkdir(parents=True, exist_ok=True)
        cloud, out = folder / "square.ply", folder / "out"
        write_ply(cloud, square(10.0, 0.02) + [(3.0, 2.0, 4.0, 100.0)])
        write_run(write_map, out)
        browser = Chromium()
        try:
            page = browser.page()
            viewing = Viewing(adit, cloud)
            check_cloud(page, viewing.link)
            check_section(page, viewing.link)
            check_dark(page)
            viewing.end()
            viewing = Viewing(adit, out, "--edit")
            check_world(page, viewing.link)
            check_picture(page, viewing.link, pictures)
            check_export(page, viewing.link, adit, folder)
            check_keyframes(page, viewing.link)
            check_graph(page, viewing.link, pictures)
            check_overlay(page, viewing.link)
            check_layers(page, viewing.link)
            check_proposal(page, viewing.link)
            check_time(page, viewing.link)
            check_plots(page, viewing.link)
            viewing, _ = check_restart(page, adit, viewing, out)
            check_phone(page, viewing.link, pictures)
            text = viewing.end()
            page.call("Emulation.clearDeviceMetricsOverride")
            page.call("Emulation.setTouchEmulationEnabled", enabled=False)
            check_truth(page, adit, out)
            require(page.errors == [], "the console has errors", *page.errors)
            require("refused" not in text, "the page itself was refused something", text)
        finally:
            browser.close()
    print("in_chromium: loads, draws, picks, measures, scrubs, edits, comes back; desktop and phone")


if __name__ == "__main__":
    main()
