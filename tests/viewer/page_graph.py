# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""The graph in the page of `adit view`: keyframes, loops, what they are edited to, the truth beside them."""

import json
import math
import re

from page_hands import ALL_THERE, GREEN, ORANGE, facts, only_canvas, place
from viewing import Viewing, require


def last_x(page):
    return page.evaluate("window.adit.graphShown.keyframes.pose[7 * 5]")


def click_loop(page, verdict):
    """Between two of the keyframes it goes past."""
    page.click(*place(page, 24.6, 0, 0))
    told = facts(page)
    require(told[""] == f"loop 1: {verdict}" and told["keyframes"] == "0 and 5", "another loop was clicked", told)


def check_graph(page, link, pictures):
    above = f"eye=24,0,0,45,{-math.pi / 2:.5f},1.5707&layers=loops,keyframes"
    page.open(f"{link}#{above}")
    page.wait(ALL_THERE)
    page.wait("window.adit.graphShown.loops.length === 2")
    require(abs(last_x(page) - 50) < 1e-6, "the last keyframe is elsewhere", last_x(page))
    green = only_canvas(page, lambda: page.count(GREEN))["count"]
    require(green > 1000, "the accepted loop is not drawn", green)
    page.click(*place(page, 20, 0, 0))
    told = facts(page)
    require(told[""] == "keyframe 2" and told["x, y, z"].startswith("20.000, 0.000, 0.000"), "another keyframe", told)
    page.screenshot(pictures / "graph.png")

    click_loop(page, "accepted")
    page.click_on("act-revoke")
    page.wait("window.adit.graphShown.loops[0].verdict === 'revoked'")
    require(only_canvas(page, lambda: page.count(GREEN))["count"] < 0.2 * green, "the revoked loop is still drawn as accepted")
    require(page.evaluate("document.getElementById('notice').textContent").startswith("Loop 1 is revoked"), "it is not said")
    require(facts(page)[""] == "loop 1: revoked", "what is told is old", facts(page))
    require(abs(last_x(page) - 50) < 0.01, "without the loop it lies where the odometry has it", last_x(page))
    page.click_on("act-restore")
    page.wait("window.adit.graphShown.loops[0].verdict === 'accepted'")
    x = last_x(page)
    require(49.0 < x < 49.9, "the loop draws the last keyframe nearer", x)
    require(only_canvas(page, lambda: page.count(GREEN))["count"] > 0.8 * green, "the restored loop is not drawn")

    # Points go with their keyframes: those of the last wall, whose middle is above and below it.
    page.evaluate("window.adit.close()")
    page.evaluate(f"location.hash = 'eye=48,4,0,6,{-math.pi / 2:.5f},0.3&layers='")
    page.wait(f"Math.abs(window.adit.controls.eye.distance - 6) < 1e-3 && {ALL_THERE}")
    page.click(*place(page, x, 4, 0.5))
    told = facts(page)
    found = [float(number) for number in re.findall(r"-?\d+\.\d+", told.get("x, y, z", ""))]
    require(told[""] == "point" and told["keyframe"] == "5" and math.dist(found, (x, 4, 0.5)) < 0.06 and
            abs((found[0] - x) * 10 - round((found[0] - x) * 10)) < 0.05, "the points did not follow", told, x)


def check_layers(page, link):
    """Ellipsoids have a height, and the second sweep is not held upwards."""
    side, nothing = f"eye=24,0,0,45,{-math.pi / 2:.5f},0", "box=0,0,100,1,1,101,0"
    page.open(f"{link}#{side}&{nothing}&layers=ellipses")
    page.wait("window.adit.painter.isIdle && window.adit.graphShown")
    drawn = only_canvas(page, lambda: page.count([0xb0, 0x50, 0x8c]))["count"]
    require(drawn > 500, "ellipses are flat", drawn)
    page.evaluate(f"location.hash = '{side}&{nothing}&layers=weak'")
    page.wait("window.adit.state.layers.join() === 'weak' && window.adit.painter.isIdle")
    drawn = only_canvas(page, lambda: page.count([0xa4, 0x26, 0x2c]))["count"]
    require(15 < drawn < 80, "the weak direction is not drawn", drawn)


def check_overlay(page, link):
    """The last wall ends at x = 53.9 as the odometry has it, at 52.9 as the loop has it."""
    page.open(f"{link}#eye=24,0,0,45,{-math.pi / 2:.5f},1.5707&layers=loops")
    page.wait(ALL_THERE)
    click_loop(page, "accepted")
    page.click_on("act-overlay")
    page.wait("location.hash.includes('overlaid=1,map')")
    require(page.evaluate("document.getElementById('key').textContent").split() == ["earlier", "later"], "no legend")
    close = f"eye=53,4,0.5,4,{-math.pi / 2:.5f},0&layers=&overlaid=1"
    for by, end in (("odometry", 53.9), ("loop", 52.9)):
        page.open(f"{link}#{close},{by}")
        page.wait(ALL_THERE)
        pressed = page.evaluate("document.querySelector('#acts [aria-pressed=true]').textContent")
        require(pressed == f"by the {by}", "another is shown", pressed)
        found = [page.evaluate("!!window.adit.pointAt(...%s, 3)" % json.dumps(place(page, x, 4, 0.5)))
                 for x in (end, end + 0.2)]
        require(found == [True, False], f"by the {by} the wall ends elsewhere", found)
        require(only_canvas(page, lambda: page.count(ORANGE))["count"] > 1000, "it has another colour")
    page.click_on("act-all-points")
    page.wait("!location.hash.includes('overlaid') && window.adit.painter.isIdle")


def check_truth(page, adit, out):
    """The last keyframe was further on: its wall has the colour of the largest error."""
    path = [(10.0 * k + 2.5 * i if k < 4 else 40 + 3.0 * i, 2 * k + i / 2) for k in range(5) for i in range(4)] + [(52, 10)]
    truth = out.parent / "truth.tum"
    truth.write_text("".join(f"{1_700_000_000 + t} {x} 0 0 0 0 0 1\n" for x, t in path), encoding="ascii")
    viewing = Viewing(adit, out, "--truth", truth)
    page.open(f"{viewing.link}#eye=25,4,0.5,45,{-math.pi / 2:.5f},0&layers=&colour=error&shading=0")
    page.wait(ALL_THERE)
    error = page.evaluate("window.adit.graphShown.truth.error")
    require(abs(error[5] - (52 - last_x(page))) < 1e-3 and max(error[:5]) < 1, "another error", error)
    require(page.evaluate("document.getElementById('most').textContent") == f"{error[5]:.3f} m", "another scale")
    most = only_canvas(page, lambda: page.count([0xdc, 0xd6, 0x4a]))["count"]
    require(most > 1000, "the largest error has no colour", most)
    page.evaluate("location.hash = 'eye=24,0,0,45,-1.5708,1.5707&box=0,0,100,1,1,101,0&layers=truth'")
    page.wait("window.adit.state.layers.join() === 'truth' && window.adit.painter.isIdle")
    require(only_canvas(page, lambda: page.count([0, 0x72, 0xb2]))["count"] > 200, "the true way is not drawn")
    viewing.end()


def check_proposal(page, link):
    """Two walls alone hold no pose, so a loop between them is refused, and nothing changes."""
    page.open(f"{link}#eye=24,0,0,45,{-math.pi / 2:.5f},1.5707&layers=keyframes")
    page.wait(ALL_THERE)
    page.click(*place(page, 10, 0, 0))
    page.click_on("act-propose-a-loop")
    page.click(*place(page, 30, 0, 0))
    page.click_on("act-loop-with-1")
    page.wait("document.getElementById('notice').textContent.includes('there is no loop as it was said')", 60)
    require(page.evaluate("window.adit.graphShown.loops.length") == 2, "there is another loop")
