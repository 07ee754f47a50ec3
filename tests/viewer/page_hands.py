# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""What a test does in the page of `adit view`, and sees there."""

import math

HALF_FIELD = math.radians(29)  # of the window's narrower side (controls.ts)
ALL_THERE = "window.adit.cloud && window.adit.cloud.drawn > 0 && window.adit.cloud.missing === 0 && window.adit.painter.isIdle"
OVER_IT = "document.querySelectorAll('#marks, #under, header, aside, footer, #notice')"
ONLY_CANVAS = OVER_IT + ".forEach((e) => { e.style.visibility = 'hidden'; })"
ALL_AGAIN = OVER_IT + ".forEach((e) => { e.style.visibility = ''; })"
# Where a place of the map frame is on the screen.
PLACE = """(() => { const { cloud, painter } = window.adit;
  const { matrixWorldInverse, projectionMatrix } = painter.camera;
  const p = cloud.origin.clone().set(%s).sub(cloud.origin).applyMatrix4(matrixWorldInverse).applyMatrix4(projectionMatrix);
  return [(0.5 + 0.5 * p.x) * painter.width, (0.5 - 0.5 * p.y) * painter.height]; })()"""
WHITE, DARK, GREEN, ORANGE = [255, 255, 255], [0x15, 0x18, 0x1c], [0x00, 0x9e, 0x73], [0xd5, 0x5e, 0x00]


def place(page, x, y, z):
    return page.evaluate(PLACE % f"{x}, {y}, {z}")


def facts(page):
    """What is told of what was clicked, by name."""
    return page.evaluate("""(() => {
        const title = document.getElementById('told').hidden ? '' : document.getElementById('what').textContent;
        const terms = [...document.querySelectorAll('#facts dt')];
        return Object.fromEntries([['', title], ...terms.map((term) => [term.textContent, term.nextSibling.textContent])]);
    })()""")


def only_canvas(page, count):
    page.evaluate(ONLY_CANVAS)
    result = count()
    page.evaluate(ALL_AGAIN)
    return result


def near(found, expected, share):
    return abs(found - expected) <= share * expected
