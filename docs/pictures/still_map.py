#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Draws a finished map and its trajectory as a WebP: the pictures of docs/guides.

Usage: still_map.py OUT CLOUD.las PICTURE.webp [TOP], from Debian's python3-numpy and python3-pil. Points more than TOP
metres above the sensor are left out, which opens rooms from above. The pictures of the guides, with the options of
`adit simulate` and TOP:

    mid360     office --sensor Mid-360 --trajectory walk --duration 60                 0.7
    ouster     forest --sensor OS1-64 --trajectory walk --duration 40
    velodyne   mine --sensor VLP-16 --duration 60                                      0.7
    hesai      city --sensor HDL-32E --fields hesai --duration 20
    ros2_bag   wings --sensor VLP-16 --trajectory walk --duration 60                   0.7

    adit simulate SCENE ... --seed 5 -o NAME.mcap
    adit run NAME.mcap -o NAME
    adit export NAME --cloud las --resolution 0.06 --without-moving --frame map -o NAME.las
    docs/pictures/still_map.py NAME NAME.las docs/pictures/guide_NAME.webp TOP
"""

import pathlib
import sys

import numpy as np
from PIL import ImageDraw

from growing_map import HEIGHT, WIDTH, Canvas, colours_of, corners, read_las

QUALITY = 60


def main():
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    run, cloud, target = sys.argv[1:4]
    points, times = read_las(cloud)
    poses = np.loadtxt(pathlib.Path(run) / "trajectory.tum")
    if len(sys.argv) == 5:
        # The file's times may have another epoch; both start with the first sweep.
        height = np.interp(times - times.min(), poses[:, 0] - poses[0, 0], poses[:, 3])
        points = points[points[:, 2] < height + float(sys.argv[4])]
    colours = colours_of(points, *np.percentile(points[:, 2], (1, 99)))
    # A coarse canvas finds the scale at which the whole map fits into the picture.
    zoom = 1 / Canvas(points[:: max(1, len(points) // 100000)], colours, 1.0).whole[1]
    canvas = Canvas(points, colours, zoom)
    canvas.add(0, len(points))
    image, corner, pixels = canvas.picture(canvas.whole[0], canvas.whole[1], None)
    track = [tuple(one) for one in (canvas.project(poses[:, 1:4]) - corner) / pixels]
    ImageDraw.Draw(image).line(track, fill=(255, 92, 92), width=2, joint="curve")
    image.putalpha(corners())
    image.save(target, quality=QUALITY, method=6)
    print(f"wrote  {target} ({WIDTH} x {HEIGHT}, {pathlib.Path(target).stat().st_size / 1e3:.0f} kB)")


if __name__ == "__main__":
    main()
