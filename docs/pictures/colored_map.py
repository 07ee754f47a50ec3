#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Draws a cloud in the colours of cameras as a WebP: the picture of docs/coloring.md.

Usage: colored_map.py OUT CLOUD.las PICTURE.webp [TOP], from Debian's python3-numpy and python3-pil. Points more than TOP
metres above the sensor are left out, which opens rooms from above, and so are points that no camera saw. The picture:

    adit simulate office --trajectory walk --duration 40 --seed 7202 --camera front --camera left --camera right \
        -o office.mcap
    adit run office.mcap -o office
    adit export office --dense las --colorize --frame map -o office.las
    docs/pictures/colored_map.py office office.las docs/pictures/colors.webp 0.7
"""

import pathlib
import struct
import sys

import numpy as np

from growing_map import HEIGHT, WIDTH, Canvas, corners, read_las

QUALITY = 70


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
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    run, cloud, target = sys.argv[1:4]
    points, times = read_las(cloud)
    colors = read_colors(cloud)[:len(points)]
    poses = np.loadtxt(pathlib.Path(run) / "trajectory.tum")
    kept = colors.any(axis=1)
    if len(sys.argv) == 5:
        # The file's times may have another epoch; both start with the first sweep.
        height = np.interp(times - times.min(), poses[:, 0] - poses[0, 0], poses[:, 3])
        kept &= points[:, 2] < height + float(sys.argv[4])
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
