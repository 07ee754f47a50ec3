#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How much of what has changed between two sessions `adit changes` finds, and what it reports wrongly.

Usage: changed_objects.py ADIT -o FOLDER. Simulates a scene twice, the second time with a share of its movable objects
gone, elsewhere or more than before, maps both, merges the maps, and holds what `adit changes` lists against the truth
of the simulator. An object counts if the map of the session that has it has at least 30 points of it, one a voxel of 5
cm, and if of two submaps of the other session the rays to at least 10 points each pass through its box. It is found if a reported object of its kind lies with more than half of
its volume in its box, 0.15 m larger on each side. Such a report is correct; the others are wrong.

One line a run: objects that count and their volume, recall (share of the volume that is found), the share of the
found objects' points that lie in reported boxes, reports, precision (share of reported volume that is correct), and
the points of wrong reports among all points that were compared.

Exit codes: 0 done, 1 a command failed, 2 usage.
"""

import argparse
import json
import pathlib
import subprocess
import sys

try:
    import numpy as np
except ImportError as error:
    print(f"changed_objects.py: {error}; pip install numpy", file=sys.stderr)
    sys.exit(2)

# Scene: way of moving, seconds, further options.
SCENES = {"office": ("walk", 40, []), "room": ("handheld", 30, []), "city": ("walk", 20, ["--sensor", "OS0-128", "--speed", "2", "--begin", "270"]),
          "mine": ("walk", 30, [])}
LEAST = 30  # points of an object
LEAST_RAYS = 10  # of a submap, through its box
MARGIN = 0.15  # m: half a voxel and the error of the map
GPS_TO_UNIX = 1e9 + 315964800 - 18  # of adjusted standard GPS time, s


def adit(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"changed_objects.py: adit {' '.join(map(str, arguments))}: {done.stderr.strip()}")
    return done.stdout


def read_las(file):
    """Points (m) and UNIX times (s) of a LAS 1.4 file of format 6 or above."""
    data = np.memmap(file, dtype=np.uint8, mode="r")
    begin = int(data[96:100].view("<u4")[0])
    size = int(data[105:107].view("<u2")[0])
    count = int(np.frombuffer(data[247:255].tobytes(), "<u8")[0])
    scale, offset = (np.frombuffer(data[at : at + 24].tobytes(), "<f8") for at in (131, 155))
    rows = np.asarray(data[begin : begin + count * size].reshape(count, size))
    places = np.ascontiguousarray(rows[:, :12]).view("<i4") * scale + offset
    return places, np.ascontiguousarray(rows[:, 22:30]).view("<f8")[:, 0] + GPS_TO_UNIX


def read_tum(file):
    return np.array([list(map(float, line.split())) for line in open(file, encoding="ascii")
                     if line.strip() and not line.startswith("#")])


def positions_at(times, table):
    return np.stack([np.interp(times, table[:, 0], table[:, k]) for k in (1, 2, 3)], axis=1)


def rigid(source, target):
    """Rotation and translation that bring one set of points to the other, by least squares."""
    middle, goal = source.mean(0), target.mean(0)
    u, _, v = np.linalg.svd((source - middle).T @ (target - goal))
    turn = v.T @ np.diag([1, 1, np.sign(np.linalg.det(v.T @ u.T))]) @ u.T
    return turn, goal - turn @ middle


class Box:
    """An upright box of the world frame."""

    def __init__(self, entry, turn=np.eye(3), shift=np.zeros(3)):
        yaw = np.radians(entry["yaw_deg"])
        ahead = turn @ np.array([np.cos(yaw), np.sin(yaw), 0])
        yaw = np.arctan2(ahead[1], ahead[0])
        self.axes = np.array([[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]])
        self.centre = turn @ np.array(entry["centre_m"]) + shift
        self.half = 0.5 * np.array(entry["size_m"])
        self.volume = float(np.prod(np.maximum(2 * self.half, 0.02)))

    def contains(self, points, margin=0.0):
        return (np.abs((points - self.centre) @ self.axes.T) <= self.half + margin).all(1)

    def samples(self, number=8):
        steps = (np.arange(number) + 0.5) / number * 2 - 1
        grid = np.stack(np.meshgrid(steps, steps, steps), -1).reshape(-1, 3)
        return self.centre + (grid * self.half) @ self.axes

    def passed(self, sensors, points):
        """Rays that go into the box and end at least 0.3 m behind it."""
        begin = (sensors - self.centre) @ self.axes.T
        way = (points - sensors) @ self.axes.T
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = (-self.half - begin) / way, (self.half - begin) / way
        enters, leaves = np.minimum(one, other).max(1), np.maximum(one, other).min(1)
        length = np.linalg.norm(way, axis=1)
        return (enters < leaves) & (enters > 0) & (leaves * length + 0.3 < length)


class Session:
    """The points of a map and where they were seen from, in the world frame."""

    def __init__(self, program, folder, name):
        las = folder / f"{name}.las"
        adit(program, "export", folder / name / "map.adit", "--cloud", "las", "--resolution", "0.05", "-o", las)
        places, times = read_las(las)
        las.unlink()
        path = read_tum(folder / name / "trajectory.tum")
        self.truth = read_tum(folder / f"{name}.truth.tum")
        turn, shift = rigid(path[:, 1:4], positions_at(path[:, 0], self.truth))
        self.points = places @ turn.T + shift
        self.sensors = positions_at(times, self.truth)
        csv = folder / f"{name}.csv"
        adit(program, "export", folder / name / "map.adit", "--trajectory", "csv", "-o", csv)
        rows = [line.split(",")[1:3] for line in csv.read_text().split("\n")[1:] if line]
        csv.unlink()
        begins = [float(stamp) for i, (keyframe, stamp) in enumerate(rows) if i == 0 or keyframe != rows[i - 1][0]]
        self.submaps = np.searchsorted(begins, times + 1e-3)

    def returns(self, box):
        return self.points[box.contains(self.points, 0.05)]

    def looks_through(self, box):
        """The rays of at least two submaps go through the box, enough of each."""
        rays = np.bincount(self.submaps[box.passed(self.sensors, self.points)])
        return (rays >= LEAST_RAYS).sum() >= 2


def prepare(program, folder, scene, seed, share):
    style, duration, more = SCENES[scene]
    common = ["simulate", scene, "--trajectory", style, "--duration", duration, "--seed", seed, "--quiet", *more]
    if not (folder / "a.mcap").exists():
        adit(program, *common, "-o", folder / "a.mcap")
    if not (folder / "b.mcap").exists():
        adit(program, *common, "--noise-seed", seed + 500, "--later", 86400, "--change", share, "--change-seed", seed,
             "-o", folder / "b.mcap")
    for name in "ab":
        if not (folder / name / "map.adit").exists():
            adit(program, "run", folder / f"{name}.mcap", "-o", folder / name, "--quiet")
    if not (folder / "m.adit").exists():
        adit(program, "merge", "--same-site", folder / "a", folder / "b", "-o", folder / "m.adit", "--quiet")


def objects_that_count(folder, before, after):
    """Truth by kind: (box, returns) of objects that both sessions know enough of."""
    counted = {"gone": [], "new": []}
    for change in json.loads((folder / "b.truth.changes.json").read_text())["changes"]:
        kind, has, other = ("gone", before, after) if change["what"] == "removed" else ("new", after, before)
        box = Box(change)
        if np.linalg.norm(has.sensors - box.centre, axis=1).min() > 60:
            continue
        returns = has.returns(box)
        if len(returns) >= LEAST and other.looks_through(box):
            counted[kind].append((box, returns, change["label"]))
    return counted


def measure(program, folder, scene, seed, share, verbose):
    folder.mkdir(parents=True, exist_ok=True)
    prepare(program, folder, scene, seed, share)
    report = json.loads(adit(program, "changes", folder / "m.adit", "--json", "--quiet"))
    sessions = [Session(program, folder, name) for name in "ab"]
    adit(program, "export", folder / "m.adit", "--trajectory", "tum", "-o", folder / "m.tum")
    path = read_tum(folder / "m.tum")
    truth = np.concatenate([session.truth for session in sessions])
    turn, shift = rigid(path[:, 1:4], positions_at(path[:, 0], truth))
    truth = objects_that_count(folder, *sessions)
    # Reports in objects that count for nothing are neither correct nor wrong.
    every = [(("gone" if c["what"] == "removed" else "new"), Box(c))
             for c in json.loads((folder / "b.truth.changes.json").read_text())["changes"]]
    reports = [(c["change"], Box(c, turn, shift), c) for c in report["changes"]]
    found = {id(box): False for kind in truth for box, _, _ in truth[kind]}
    right = wrong = lost = 0
    for kind, box, entry in reports:
        inside = [other.contains(box.samples(), MARGIN).mean() for k, other in every if k == kind]
        for other, _, _ in truth[kind]:
            found[id(other)] |= other.contains(box.samples(), MARGIN).mean() > 0.5
        if inside and max(inside) > 0.5:
            right += box.volume
        else:
            wrong += box.volume
            lost += entry["points"]
            if verbose:
                print("wrong", kind, np.round(box.centre, 2), np.round(2 * box.half, 2), entry["points"],
                      entry["submaps_through"], file=sys.stderr)
    counted = [one for kind in truth for one in truth[kind]]
    volume = sum(box.volume for box, _, _ in counted)
    caught = sum(box.volume for box, _, _ in counted if found[id(box)])
    covered = sum(
        box.volume * np.any([other.contains(returns, 0.1) for k, other, _ in reports if k == kind] or
                            [np.zeros(len(returns), bool)], axis=0).mean()
        for kind in truth for box, returns, _ in truth[kind] if found[id(box)])
    if verbose:
        for kind in truth:
            for box, returns, label in truth[kind]:
                if not found[id(box)]:
                    print("missed", kind, label, np.round(box.centre, 2), np.round(2 * box.half, 2), len(returns),
                          file=sys.stderr)
    print(f"| {scene} | {seed} | {len(counted)} | {volume:.1f} | {caught / max(volume, 1e-9):.3f} | "
          f"{covered / max(caught, 1e-9):.2f} | {len(reports)} | {right / max(right + wrong, 1e-9):.3f} | "
          f"{100 * lost / report['points']:.2f} % |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="adit")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="folder for recordings and maps")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=["office", "room", "city"])
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--change", type=float, default=0.2, help="share of the movable objects")
    parser.add_argument("--verbose", action="store_true", help="list missed objects and wrong reports")
    options = parser.parse_args()
    print("| scene | seed | objects | volume, m3 | recall | of their points | reports | precision | lost |")
    print("|---|---|---|---|---|---|---|---|---|")
    for scene in options.scenes:
        for seed in options.seeds:
            measure(options.program, options.output / f"{scene}-{seed}", scene, seed, options.change, options.verbose)


if __name__ == "__main__":
    main()
