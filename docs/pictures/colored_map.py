#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Draws a cloud in the colours of cameras as a WebP: the picture of docs/coloring.md.

Usage: colored_map.py OUT CLOUD.las PICTURE.webp, from Debian's python3-numpy and python3-pil. Points more than REACH
from the sensor, and points that no camera saw, are left out. The picture:

    adit simulate city --trajectory drive --duration 20 --seed 7202 --camera front --camera left --camera right \
        -o city.mcap
    adit run city.mcap -o city
    adit export city --dense las --colorize --find-moving --frame map -o city.las
    docs/pictures/colored_map.py city city.las docs/pictures/colors.webp
"""

import pathlib
import struct
import sys

import numpy as np

from growing_map import HEIGHT, WIDTH, Canvas, corners, read_las

QUALITY = 70
REACH = 30.0  # m: farther away, the lines of a VLP-16 are far apart


def read_colors(path):
    """Red, green and blue, 0 to 255, of a LAS file of point format 7."""
    data = np.memmap(path, np.uint8, "r")
    begin, = struct.unpack_from("<I", data, 96)
    form, size = struct.unpack_from("<BH", data, 104)
    if form != 7:
        sys.exit(f"{path}: expected point format 7, as adit export --colorize writes it")
    rows = data[begin:begin + (len(data) - begin) // size * size].reshape(-1, size)
    return np.ascontiguousarray(rows[:, 30:36]).view("<u2").astype(np.float32) / 257


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    run, cloud, target = sys.argv[1:]
    points, times = read_las(cloud)
    colors = read_colors(cloud)[:len(points)]
    poses = np.loadtxt(pathlib.Path(run) / "trajectory.tum")
    # The file's times may have another epoch; both start with the first sweep.
    times = times - times.min() + poses[0, 0]
    sensor = np.stack([np.interp(times, poses[:, 0], poses[:, k]) for k in (1, 2, 3)], axis=1)
    kept = colors.any(axis=1) & (np.linalg.norm(points - sensor, axis=1) < REACH)
    points, colors = points[kept], colors[kept]
    # A coarse canvas finds the scale at which the whole map fits into the picture.
    step = max(1, len(points) // 100000)
    canvas = Canvas(points[::step], colors[::step], 1.0)
    canvas = Canvas(points, colors, 1 / canvas.whole[1])
    canvas.add(0, len(points))
    image, _, _ = canvas.picture(canvas.whole[0], canvas.whole[1], None)
    image.putalpha(corners())
    image.save(target, quality=QUALITY, method=6)
    print(f"wrote  {target} ({WIDTH} x {HEIGHT}, {pathlib.Path(target).stat().st_size / 1e3:.0f} kB)")


if __name__ == "__main__":
    main()
