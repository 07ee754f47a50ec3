#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""`adit.align` beside small_gicp and KISS-Matcher on clouds whose relative poses are known.

Usage: align_peers.py FOLDER... [--starts N] [--seed N]. A FOLDER has one of
- target.ply, source.ply and T_target_source.txt, as registration_pair of the shared data;
- graph.txt with a pose a line and a cloud each, NNNNNN/points.bin or planes_*.bin and edges_*.bin, as its submaps_*:
  neighbours are paired;
- drive.mcap, drive.truth.tum and map.adit, as `adit simulate` and `adit run` write them: submaps are paired with the
  second next.
Needs the Python package adit, and small_gicp and kiss-matcher of the Python package index; a system that is missing is
left out.

Two tasks, N starts each (80) and folder, shared out over its pairs:
- from a guess: off in a random direction and about a random axis, a quarter each by 0.5 m and 5 degrees, 1 m and 10,
  1.5 m and 15, and 2 m and 20;
- from nothing: the source turned by any yaw, tilted by up to 5 degrees and shifted by up to 10 m.

Right is within 0.1 m and 1 degree of the reference. `usable` is what a system says of its own result: adit's verdict,
`converged` of small_gicp, `valid` and at least 5 final inliers of KISS-Matcher. KISS-Matcher takes no guess and is
coarse; a row has small_gicp go on from its result. All settings are defaults, but that small_gicp gets as many threads
as there are processors. Times are those of a whole call, preparation of both clouds included: on the clock, and of all
processors together, which a busy machine changes less.

Prints a table, as Markdown. Exit codes: 0 done, 2 usage.
"""

import argparse
import importlib.metadata
import os
import pathlib
import statistics
import sys
import time

import numpy as np

import adit

RIGHT_M, RIGHT_DEGREES = 0.1, 1.0
LEVELS = ((0.5, 5.0), (1.0, 10.0), (1.5, 15.0), (2.0, 20.0))
VOXEL_M = 0.3  # KISS-Matcher's default
FEWEST_INLIERS = 5


def rotation(axis, angle):
    """About a unit axis by an angle (rad)."""
    k = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k


def direction(random):
    vector = random.normal(size=3)
    return vector / np.linalg.norm(vector)


def pose(R, t):
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, t
    return T


def guess_from(truth, i, count, random):
    """Start i of count."""
    metres, degrees = LEVELS[i * len(LEVELS) // count]
    return truth @ pose(rotation(direction(random), np.radians(degrees)), metres * direction(random))


def displacements(count, random):
    """Poses that the source is moved by."""
    for _ in range(count):
        level = np.array([*direction(random)[:2], 0.0])
        tilt = rotation(level / np.linalg.norm(level), np.radians(random.uniform(0.0, 5.0)))
        turn = rotation(np.array([0.0, 0.0, 1.0]), random.uniform(-np.pi, np.pi))
        yield pose(tilt @ turn, random.uniform(0.0, 10.0) * direction(random))


def moved(points, T):
    result = points.copy()
    result[:, :3] = points[:, :3] @ T[:3, :3].T + T[:3, 3]
    return result


def is_right(found, truth):
    off = np.linalg.inv(truth) @ found
    angle = np.degrees(np.arccos(np.clip((np.trace(off[:3, :3]) - 1.0) / 2.0, -1.0, 1.0)))
    return np.linalg.norm(off[:3, 3]) <= RIGHT_M and angle <= RIGHT_DEGREES


def posed(line):
    """The pose of x y z qx qy qz qw."""
    x, y, z, w = np.array(line[3:], float) / np.linalg.norm(np.array(line[3:], float))
    R = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                  [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                  [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    return pose(R, np.array(line[:3], float))


def cloud(*files):
    points = np.concatenate([np.fromfile(file, "<f4").reshape(-1, 3) for file in files])
    return np.ascontiguousarray(np.pad(points, ((0, 0), (0, 1))))


def graph_pairs(folder):
    poses = [posed(line.split()[1:]) for line in (folder / "graph.txt").read_text().splitlines()]
    clouds = [cloud(file) for file in sorted(folder.glob("*/points.bin"))] or [
        cloud(planes, edges) for planes, edges in zip(sorted(folder.glob("planes_*")), sorted(folder.glob("edges_*")))]
    for i in range(len(poses) - 1):
        yield clouds[i], clouds[i + 1], np.linalg.inv(poses[i]) @ poses[i + 1]


def map_pairs(folder):
    slam = adit.Slam.for_recording(recording := adit.open(folder / "drive.mcap"))
    next(iter(slam.process(recording)))  # its transforms are known then
    recorded, truth = adit.Map(folder / "map.adit"), adit.Trajectory.read(folder / "drive.truth.tum")
    mapped = dict(zip(recorded.trajectory().stamps.tolist(), recorded.trajectory().poses))
    keyframes = list(recorded.keyframes)
    poses = []
    for one in keyframes:
        nearest = np.abs(truth.stamps - one.stamp).argmin()  # the truth has a pose each 5 ms
        # The truth is of the IMU; a keyframe's axes are upright, the sensor's are not.
        poses.append(truth.poses[nearest] @ slam.mounting @ np.linalg.inv(mapped[one.stamp]) @ one.pose)
    for i in range(len(keyframes) - 2):
        yield (padded(recorded, keyframes[i]), padded(recorded, keyframes[i + 2]),
               np.linalg.inv(poses[i]) @ poses[i + 2])


def padded(recorded, keyframe):
    return np.ascontiguousarray(np.pad(recorded.submap(keyframe.id).points[:, :3], ((0, 0), (0, 1))))


def pairs_in(folder):
    """(target, source, T_target_source)."""
    if (folder / "graph.txt").exists():
        return list(graph_pairs(folder))
    if (folder / "map.adit").exists():
        return list(map_pairs(folder))
    target, source = (next(iter(adit.open(folder / name).events())).points for name in ("target.ply", "source.ply"))
    return [(target, source, np.loadtxt(folder / "T_target_source.txt").reshape(4, 4))]


def by_adit(target, source, guess):
    alignment = adit.align(target, source, guess)
    return alignment.T_a_b, alignment.usable


def by_small_gicp(target, source, guess):
    result = small_gicp.align(target[:, :3].astype(np.float64), source[:, :3].astype(np.float64),
                              init_T_target_source=guess, num_threads=os.cpu_count() or 1)
    return result.T_target_source, result.converged


def by_kiss_matcher(target, source, guess):
    del guess  # it takes none
    matcher = kiss_matcher.KISSMatcher(kiss_matcher.KISSMatcherConfig(VOXEL_M))
    result = matcher.estimate(source[:, :3].astype(np.float32), target[:, :3].astype(np.float32))
    usable = result.valid and matcher.get_num_final_inliers() >= FEWEST_INLIERS
    return pose(np.asarray(result.rotation), np.asarray(result.translation).ravel()), usable


def by_both(target, source, guess):
    found, usable = by_kiss_matcher(target, source, guess)
    refined, converged = by_small_gicp(target, source, found)
    return refined, usable and converged


SYSTEMS = [("adit", by_adit, True, True)]
try:
    import small_gicp
    SYSTEMS.append(("small_gicp", by_small_gicp, True, False))
except ImportError:
    pass
try:
    import kiss_matcher
    SYSTEMS.append(("kiss-matcher", by_kiss_matcher, False, True))
    if len(SYSTEMS) == 3:
        SYSTEMS.append(("kiss-matcher, then small_gicp", by_both, False, True))
except ImportError:
    pass


def measured(system, cases):
    """(right, wrong but called usable, refused, median ms, median ms of processors) of cases (target, source, guess,
    truth)."""
    right = wrong = refused = 0
    times, busy = [], []
    system(*cases[0][:3])  # whatever is made once
    for target, source, guess, truth in cases:
        begin, began = time.perf_counter(), time.process_time()
        found, usable = system(target, source, guess)
        times.append(1e3 * (time.perf_counter() - begin))
        busy.append(1e3 * (time.process_time() - began))
        if not usable:
            refused += 1
        elif is_right(found, truth):
            right += 1
        else:
            wrong += 1
    return right, wrong, refused, statistics.median(times), statistics.median(busy)


def version_of(name):
    names = name.split(", then ")
    return ", then ".join(f"{one} {adit.version() if one == 'adit' else importlib.metadata.version(one)}" for one in names)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("folders", type=pathlib.Path, nargs="+", metavar="FOLDER")
    parser.add_argument("--starts", type=int, default=80)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(f"{options.starts} starts each, seed {options.seed}, {adit.Device().name}, {os.cpu_count()} processors\n")
    print("| clouds | task | system | right | wrong, called usable | refused | ms, median | ms of processors |\n"
          "|---|---|---|---|---|---|---|---|")
    for folder in options.folders:
        pairs = pairs_in(folder)
        random = np.random.default_rng(options.seed)
        of = [pairs[i % len(pairs)] for i in range(options.starts)]
        guessed = [(target, source, guess_from(truth, i, options.starts, random), truth)
                   for i, (target, source, truth) in enumerate(of)]
        unknown = [(target, moved(source, move), None, truth @ np.linalg.inv(move))
                   for (target, source, truth), move in zip(of, displacements(options.starts, random))]
        for task, column, cases in (("from a guess", 2, guessed), ("from nothing", 3, unknown)):
            for entry in SYSTEMS:
                if entry[column]:
                    right, wrong, refused, ms, busy = measured(entry[1], cases)
                    print(f"| {folder.name} | {task} | {version_of(entry[0])} | {right} | {wrong} | {refused} | {ms:.0f} "
                          f"| {busy:.0f} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
