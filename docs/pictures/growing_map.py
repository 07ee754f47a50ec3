#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Draws a map as it grows, as an animated WebP: the moving picture of the README.

Usage: growing_map.py OUT CLOUD.las PICTURE.webp, from Debian's python3-numpy and python3-pil. The picture of the README:

    adit simulate city --sensor HDL-32E --duration 75 --gnss rtk -o city.mcap
    adit run city.mcap -o city
    adit export city --cloud las --resolution 0.15 --frame map -o city.las
    docs/pictures/growing_map.py city city.las docs/pictures/growing_map.webp

The camera follows the sensor, and moves away at the end until all of the map is seen. The panel is dark with transparent
corners, and looks alike on light and dark pages.
"""

import pathlib
import struct
import sys

import numpy as np
from PIL import Image, ImageDraw, ImageFont

WIDTH, HEIGHT = 880, 440
GROWING, LEAVING, FRAME_MS, LAST_MS = 56, 14, 110, 3500  # frames that follow the sensor, and that move away to the whole
AZIMUTH, ELEVATION = np.radians(-38.0), np.radians(38.0)
ZOOM, SCALE = 5.0, 2  # pixels a metre while the camera follows; drawn so many times as large, and averaged
QUALITY = 36
GROUND, SKY = -2.5, 14.0  # heights that the colours span, m
PANEL = np.array([13, 19, 28], dtype=np.float32)
COLOURS = np.array([[52, 104, 176], [48, 160, 204], [70, 208, 170], [178, 226, 106], [252, 218, 96], [255, 160, 84]],
                   dtype=np.float32)
NEW = np.array([255, 246, 214], dtype=np.float32)
FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"


def read_las(path):
    """Positions (m) and times (s) of a LAS 1.4 file."""
    data = pathlib.Path(path).read_bytes()
    begin, = struct.unpack_from("<I", data, 96)
    form, size = struct.unpack_from("<BH", data, 104)
    scale, offset = np.array(struct.unpack_from("<3d", data, 131)), np.array(struct.unpack_from("<3d", data, 155))
    count, = struct.unpack_from("<Q", data, 247)
    if data[:4] != b"LASF" or form not in (6, 7, 8):
        sys.exit(f"{path}: expected a LAS file of point format 6, as adit export writes it")
    record = np.dtype({"names": ["xyz", "time"], "formats": [("<i4", 3), "<f8"], "offsets": [0, 22], "itemsize": size})
    points = np.frombuffer(data, record, count, begin)
    return points["xyz"] * scale + offset, points["time"]


class Canvas:
    """All points seen from above and aside, without perspective: the nearest of each pixel, as far as they were added."""

    def __init__(self, points, colours, zoom=ZOOM):
        self.zoom = zoom
        a, e = AZIMUTH, ELEVATION
        right = np.array([np.cos(a), np.sin(a), 0.0])
        away = np.array([-np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), -np.sin(e)])
        self.axes = np.stack([right, -np.cross(right, away), away])
        flat = points @ self.axes.T
        self.begin, end = flat[:, :2].min(axis=0), flat[:, :2].max(axis=0)
        columns, rows = np.ceil((end - self.begin) * zoom * SCALE).astype(int) + 1
        self.depth = np.full((rows, columns), np.inf, dtype=np.float32)
        self.colour = np.zeros((rows, columns, 3), dtype=np.float32)
        self.points = ((flat[:, :2] - self.begin) * zoom * SCALE).astype(np.int32), flat[:, 2].astype(np.float32), colours
        low, high = np.percentile(flat[:, :2], 0.3, axis=0), np.percentile(flat[:, :2], 99.7, axis=0)
        self.whole = ((low + high) / 2 - self.begin) * zoom * SCALE, np.max((high - low) / (WIDTH, HEIGHT)) * zoom * 1.04

    def project(self, points):
        return ((points @ self.axes.T)[:, :2] - self.begin) * self.zoom * SCALE

    def add(self, begin, end):
        """Draws points; which pixels they took."""
        pixels, depths, colours = (array[begin:end] for array in self.points)
        order = np.argsort(-depths, kind="stable")  # the nearest is written last
        order = order[depths[order] < self.depth[pixels[order, 1], pixels[order, 0]]]
        columns, rows = pixels[order].T
        self.depth[rows, columns], self.colour[rows, columns] = depths[order], colours[order]
        return rows, columns

    def picture(self, middle, shrink, fresh):
        """What a window shows around a place, so many times smaller than the camera's usual one."""
        size = np.array([WIDTH, HEIGHT]) * SCALE * shrink
        left, top = np.round(middle - size / 2).astype(int)
        wide, high = np.round(size).astype(int)
        depth = np.full((high, wide), np.inf, dtype=np.float32)
        colour = np.zeros((high, wide, 3), dtype=np.float32)
        rows, columns = self.depth.shape
        y, x = slice(max(0, top), min(rows, top + high)), slice(max(0, left), min(columns, left + wide))
        inner = slice(y.start - top, y.stop - top), slice(x.start - left, x.stop - left)
        depth[inner], colour[inner] = self.depth[y, x], self.colour[y, x]
        if fresh is not None:
            row, column = fresh[0] - top, fresh[1] - left
            inside = (row >= 0) & (row < high) & (column >= 0) & (column < wide)
            row, column = row[inside], column[inside]
            colour[row, column] = 0.5 * colour[row, column] + 0.5 * NEW
        picture = np.clip(shaded(colour, depth), 0, 255).astype(np.uint8)
        return Image.fromarray(picture).resize((WIDTH, HEIGHT), Image.BOX), np.array([left, top]), wide / WIDTH


def colours_of(points, ground=GROUND, sky=SKY):
    place = np.clip((points[:, 2] - ground) / (sky - ground), 0, 1) ** 0.75 * (len(COLOURS) - 1)
    low = np.minimum(place.astype(int), len(COLOURS) - 2)
    share = (place - low)[:, None].astype(np.float32)
    return COLOURS[low] * (1 - share) + COLOURS[low + 1] * share


def shaded(colour, depth):
    """The picture with edges darkened where something nearer lies beside them."""
    light, far = np.zeros_like(depth), np.where(np.isfinite(depth), depth, 1e6).astype(np.float32)
    for shift in (2, 4):
        for axis in (0, 1):
            for step in (-shift, shift):
                light += np.clip(far - np.roll(far, step, axis), 0, 3.0)
    return np.where(np.isfinite(depth)[..., None], colour * np.exp(-0.05 * light)[..., None], PANEL)


def corners():
    mask = Image.new("L", (WIDTH * 4, HEIGHT * 4), 0)
    ImageDraw.Draw(mask).rounded_rectangle((0, 0, WIDTH * 4 - 1, HEIGHT * 4 - 1), radius=40, fill=255)
    return mask.resize((WIDTH, HEIGHT), Image.LANCZOS)


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    run, cloud, target = sys.argv[1:]
    points, times = read_las(cloud)
    poses = np.loadtxt(pathlib.Path(run) / "trajectory.tum")
    path = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(poses[:, 1:4], axis=0), axis=1))])
    # The file's times may count from another epoch than the trajectory's: both begin with the first sweep.
    times, moments = times - times.min(), poses[:, 0] - poses[0, 0]
    order = np.argsort(times, kind="stable")
    points, times = points[order], times[order]
    canvas = Canvas(points, colours_of(points))
    track = canvas.project(poses[:, 1:4])
    around = 60  # sweeps before and after that the camera's way is smoothed over
    padded = np.pad(track, ((around, around), (0, 0)), mode="edge")
    sums = np.cumsum(np.vstack([[0, 0], padded]), axis=0)
    camera = (sums[2 * around + 1:] - sums[:-2 * around - 1]) / (2 * around + 1)
    font, small = ImageFont.truetype(FONT, 17), ImageFont.truetype(FONT, 13)
    mask, frames, begin = corners(), [], 0
    for frame in range(1, GROWING + LEAVING + 1):
        grown = min(frame / GROWING, 1.0)
        sweep = min(int(grown * len(moments)), len(moments) - 1)
        end = len(times) if grown == 1.0 else int(np.searchsorted(times, moments[sweep]))
        fresh = canvas.add(begin, end) if end > begin else None
        begin = end
        away = np.clip((frame - GROWING) / LEAVING, 0, 1)
        away = away * away * (3 - 2 * away)
        shrink = canvas.whole[1] ** away
        # Straight towards the middle of the whole, as fast as the window grows.
        share = (shrink - 1) / (canvas.whole[1] - 1)
        middle = camera[sweep] * (1 - share) + canvas.whole[0] * share
        image, corner, pixels = canvas.picture(middle, shrink, fresh if frame < GROWING else None)
        draw = ImageDraw.Draw(image)
        line = [tuple(one) for one in (track[: sweep + 1] - corner) / pixels]
        if len(line) > 1:
            draw.line(line, fill=(255, 92, 92), width=2, joint="curve")
        x, y = line[-1]
        draw.ellipse((x - 4, y - 4, x + 4, y + 4), fill=(255, 255, 255), outline=(255, 92, 92))
        plate = Image.new("RGBA", image.size, (0, 0, 0, 0))
        ImageDraw.Draw(plate).rounded_rectangle((8, 8, 316, 60), radius=8, fill=(*PANEL.astype(int).tolist(), 200))
        image.paste(plate, mask=plate)
        draw.text((18, 14), "adit run city.mcap -o city", font=font, fill=(226, 232, 240))
        draw.text((18, 38), f"{sweep + 1} sweeps   {path[sweep]:.0f} m   {end / 1e6:.2f} million points", font=small,
                  fill=(148, 163, 184))
        image.putalpha(mask)
        frames.append(image)
    durations = [FRAME_MS] * (len(frames) - 1) + [LAST_MS]
    frames[0].save(target, save_all=True, append_images=frames[1:], duration=durations, loop=0, quality=QUALITY, method=4)
    print(f"wrote  {target} ({pathlib.Path(target).stat().st_size / 1e6:.2f} MB, {len(frames)} frames)")


if __name__ == "__main__":
    main()
