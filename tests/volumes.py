#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How well `adit volume` measures a heap whose volume is known, on the simulated field.

Usage: tests/volumes.py ADIT FOLDER [SEED...]

Needs `adit` and a device (lavapipe will do); what FOLDER holds already of a seed is not made again. A VLP-16 is carried
around the place of the heap before and after it is put there, in opposite directions. Each row: how the maps lie to
each other, the measured volume, its error in m3 and per cent, the standard error that adit states, the error in
standard errors, cut (there is none), the offset of heights, and the share of the ground within 4 m that was not seen.
"""

import json
import math
import pathlib
import re
import struct
import subprocess
import sys

MIDDLE = (30.0, 6.0)  # m, beside the barn
RADIUS, HEIGHT, WALK = 3.0, 2.0, 7.5  # m
SIDES = 48  # of the heap's mesh
VOLUME = 0.5 * SIDES * RADIUS**2 * math.sin(2 * math.pi / SIDES) * HEIGHT / 3.0


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, stdout=subprocess.PIPE, text=True).stdout


def ground_of(adit, folder, seed):
    """Vertices of the terrain, which come first in the scene."""
    recording = folder / f"ground{seed}.mcap"
    scene = recording.with_suffix(".toml")
    scene.write_text(f'scene = "field"\nseed = {seed}\nduration = 0.2\n')
    run(adit, "simulate", scene, "-o", recording, "--quiet")
    header, body = recording.with_suffix(".scene.ply").read_bytes().split(b"end_header\n", 1)
    count = int(re.search(rb"element vertex (\d+)", header).group(1))
    return [struct.unpack_from("<3f", body, 12 * i) for i in range(min(count, 334 * 334))]


def height_at(ground, x, y):
    near = sorted(ground, key=lambda v: (v[0] - x) ** 2 + (v[1] - y) ** 2)[:3]
    return sum(v[2] for v in near) / 3


def scene_text(ground, seed, after):
    way = [(MIDDLE[0] + WALK * math.cos(a), MIDDLE[1] + WALK * math.sin(a))
           for a in (2 * math.pi * i / 12 for i in range(12))]
    corners = [[round(x, 3), round(y, 3), round(height_at(ground, x, y), 3)] for x, y in way]
    text = (f'scene = "field"\nseed = {seed}\nnoise_seed = {10 * seed + after}\nlater = {86400.0 * after}\n'
            f'duration = 36.0\n[trajectory]\nstyle = "walk"\nspeed = 1.4\nreverse = {str(bool(after)).lower()}\n'
            f'waypoints = {corners}\ncorner_radius = 1.5\n[[lidar]]\nsensor = "VLP-16"\n[imu]\nmodel = "industrial"\n'
            f'[gnss]\nreceiver = "rtk"\n')
    if after:
        text += (f"[[heap]]\nat = [{MIDDLE[0]}, {MIDDLE[1]}, {height_at(ground, *MIDDLE):.3f}]\n"
                 f"radius = {RADIUS}\nheight = {HEIGHT}\n")
    return text


def mapped(adit, folder, seed):
    maps = [folder / f"{name}{seed}" for name in ("before", "after")]
    if not all((out / "summary.json").exists() for out in maps):
        ground = ground_of(adit, folder, seed)
        for after, out in enumerate(maps):
            scene, recording = out.with_suffix(".toml"), out.with_suffix(".mcap")
            scene.write_text(scene_text(ground, seed, after))
            run(adit, "simulate", scene, "-o", recording, "--quiet")
            run(adit, "run", recording, "-o", out, "--overwrite")
    return maps


def polygon_of(folder):
    """A square of 8 m around the heap, in degrees: the simulated world is a plane at 48 N, 11 E."""
    north, east = 111195.0, 111195.0 * math.cos(math.radians(48.0))
    ring = [[11.0 + (MIDDLE[0] + x) / east, 48.0 + (MIDDLE[1] + y) / north]
            for x, y in ((-4, -4), (4, -4), (4, 4), (-4, 4), (-4, -4))]
    file = folder / "heap.geojson"
    file.write_text(json.dumps({"type": "Polygon", "coordinates": [ring]}))
    return file


def measure(adit, folder, seed):
    before, after = mapped(adit, folder, seed)
    polygon = ["--polygon", polygon_of(folder)]
    for name, words in (("tied", [before, after]), ("tied, polygon", [before, after, *polygon]),
                        ("on the Earth, polygon", [before, after, *polygon, "--as-georeferenced"]),
                        ("surroundings", [after, *polygon, "--above", "surroundings"])):
        report = json.loads(run(adit, "volume", *words, "--json", "--quiet"))
        fill = report["fill"]
        error, stated = fill["volume_m3"] - VOLUME, fill["error_m3"] or math.nan
        unseen = 100 * report["unseen_after_m2"] / report["area_m2"]
        print(f"| {seed} | {name} | {fill['volume_m3']:.2f} | {error:+.2f} | {100 * error / VOLUME:+.1f} | {stated:.2f} | "
              f"{error / stated:+.1f} | {report['cut']['volume_m3']:.2f} | {1e3 * report['offset_m']:+.0f} | "
              f"{unseen:.1f} |", flush=True)


def main():
    adit, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    print(f"true volume {VOLUME:.2f} m3\n\n"
          "| seed | how | fill, m³ | error, m³ | error, % | stated, m³ | error / stated | cut, m³ | offset, mm | "
          "unseen, % |\n|---|---|---|---|---|---|---|---|---|---|")
    for seed in sys.argv[3:] or ["7502", "7503", "7504", "7505", "7506"]:
        measure(adit, folder, int(seed))


if __name__ == "__main__":
    main()
