#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""A sensor that is carried elsewhere while it is localised in a map: metres until that is noticed, and until it is
localised again.

Usage: kidnaps.py ADIT [--scenes ...] [--sensors ...] [--seeds FIRST LAST] [--fault kidnapped|covered] [--no-imu]
[--folder FOLDER] [--json FILE]. For each scene, sensor and seed it simulates and maps a recording, simulates a second
one of the same place (other noise, other motion, 10 % of the movable objects changed) with the fault, and localises
that in the map with --map --localize and --pose; with --no-imu, without its IMU. Distances are of the true path from
the fault on. `wrong` are sweeps in the state `localized` whose pose in the map's frame errs by more than 1 m.
Recordings and maps that FOLDER has already are used again. Exits 1 if a sweep is wrong.
"""

import argparse
import bisect
import csv
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

CARRIED = 20.0  # s, kCarried of tools/simulator/faults.hpp
MOTIONS = {"city": ("drive", "drive"), "mine": ("drive", "drive"), "forest": ("walk", "walk")}
SPEEDS = {"office": (2.0, 1.5), "forest": (2.0, 1.5)}  # m/s, where the scene's own are too slow for a minute
WRONG = 1.0  # m


def quaternion_matrix(x, y, z, w):
    return ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))


def read_poses(file):
    """Stamps (s) and poses (rotation, translation) of a TUM file."""
    stamps, poses = [], []
    for line in file.read_text().splitlines():
        t, *p = (float(word) for word in line.split())
        stamps.append(t)
        poses.append((quaternion_matrix(*p[3:]), p[:3]))
    return stamps, poses


def moved(pose, point):
    rotation, translation = pose
    return [sum(r * c for r, c in zip(row, point)) + t for row, t in zip(rotation, translation)]


def moved_back(pose, point):
    rotation, translation = pose
    off = [p - t for p, t in zip(point, translation)]
    return [sum(rotation[k][i] * off[k] for k in range(3)) for i in range(3)]


def distance(a, b):
    return sum((p - q) ** 2 for p, q in zip(a, b)) ** 0.5


def at(stamps, poses, time):
    return poses[min(bisect.bisect_left(stamps, time - 1e-4), len(poses) - 1)]


def run(*words):
    subprocess.run(["nice"] + [str(word) for word in words], check=True, capture_output=True)


def recordings(arguments, folder, scene, sensor, seed):
    """Makes the map and the later recording."""
    first, second = MOTIONS.get(scene, ("drive", "walk"))
    common = ["simulate", scene, "--seed", seed, "--sensor", sensor, "--quiet"]
    mapped, later = folder / "mapped.mcap", folder / "later.mcap"
    duration = 40 if arguments.fault == "kidnapped" else 60
    speeds = [["--speed", speed] for speed in SPEEDS.get(scene, ())] or [[], []]
    run(arguments.adit, *common, "--duration", 62, "--trajectory", first, *speeds[0], "-o", mapped)
    changes = [] if scene in ("forest", "equal_houses") else ["--change", 0.1]
    run(arguments.adit, *common, "--noise-seed", seed + 1000, "--later", 600, *changes, "--begin", 2, "--duration",
        duration, "--trajectory", second, *speeds[1], "--fault", arguments.fault, "-o", later)
    run(arguments.adit, "run", mapped, "-o", folder / "map", "--quiet", "--no-map")


def map_frame(folder):
    """Maps true points to the map's frame."""
    map_truth = read_poses(folder / "mapped.truth.tum")
    mapped = read_poses(folder / "map" / "online.tum")
    T_world_first, T_map_first = at(*map_truth, mapped[0][0]), mapped[1][0]
    return lambda point: moved(T_map_first, moved_back(T_world_first, point))


def start_of(folder, later):
    """X Y Z YAW of its first pose in the map's frame, m and degrees."""
    first = read_poses(later.with_suffix(".truth.tum"))[1][0]
    to_map = map_frame(folder)
    begin, ahead = to_map(first[1]), to_map(moved(first, (1.0, 0.0, 0.0)))
    return [*begin, math.degrees(math.atan2(ahead[1] - begin[1], ahead[0] - begin[0]))]


def figures(folder, later, fault_at):
    """Of one localised run."""
    to_map = map_frame(folder)
    truth = read_poses(later.with_suffix(".truth.tum"))
    online = read_poses(folder / "there" / "online.tum")
    with open(folder / "there" / "localization.csv", encoding="utf-8") as table:
        states = [row["state"] for row in csv.DictReader(table)]
    begin = truth[0][0]
    path, since, last, found = 0.0, None, None, {"first": None, "noticed": None, "again": None, "wrong": 0}
    was_localized = False
    for stamp, pose, state in zip(online[0], online[1], states):
        true = at(*truth, stamp)
        carried = stamp - begin >= fault_at - 1e-3
        path += distance(true[1], last) if last is not None and distance(true[1], last) < 5.0 else 0.0
        last = true[1]
        if carried and since is None:
            since = path
            found["localized_before"] = was_localized
        error = distance(to_map(true[1]), pose[1])
        if state == "localized":
            found["first"] = path if found["first"] is None else found["first"]
            found["wrong"] += error > WRONG
            if carried and error <= WRONG and found["noticed"] is not None and found["again"] is None:
                found["again"] = path - since
        elif carried and found["noticed"] is None and was_localized:
            found["noticed"] = path - since
        was_localized = state == "localized"
    found["path_after"] = path - since if since is not None else 0.0
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("adit", type=lambda path: pathlib.Path(path).absolute())
    parser.add_argument("--scenes", nargs="+", default=["office", "mine", "city"])
    parser.add_argument("--sensors", nargs="+", default=["VLP-16", "Mid-360"])
    parser.add_argument("--seeds", nargs=2, type=int, default=[1, 5])
    parser.add_argument("--fault", choices=["kidnapped", "covered"], default="kidnapped")
    parser.add_argument("--no-imu", action="store_true")
    parser.add_argument("--folder", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    everything, wrong = [], 0
    imu = ["--set", "imu.use=false"] if arguments.no_imu else []
    with tempfile.TemporaryDirectory() as temporary:
        for scene in arguments.scenes:
            for sensor in arguments.sensors:
                rows = []
                for seed in range(arguments.seeds[0], arguments.seeds[1] + 1):
                    name = f"{scene}-{sensor}-{seed}-{arguments.fault}"
                    folder = (arguments.folder or pathlib.Path(temporary)) / name
                    if not (folder / "map" / "summary.json").exists():
                        folder.mkdir(parents=True, exist_ok=True)
                        recordings(arguments, folder, scene, sensor, seed)
                    duration = 40 if arguments.fault == "kidnapped" else 60
                    fault_at = 0.5 * duration if arguments.fault == "kidnapped" else 0.4 * duration
                    run(arguments.adit, "run", folder / "later.mcap", "--map", folder / "map", "--localize", "-o",
                        folder / "there", "--pose", *start_of(folder, folder / "later.mcap"), "--overwrite", "--quiet",
                        "--no-map", *imu)
                    row = {"scene": scene, "sensor": sensor, "seed": seed} | figures(
                        folder, folder / "later.mcap", fault_at)
                    print(json.dumps(row), flush=True)
                    rows.append(row)
                everything += rows
                wrong += sum(row["wrong"] for row in rows)
                of = [row for row in rows if row.get("localized_before")]
                again = sorted(row["again"] if row["again"] is not None else float("inf") for row in of)
                noticed = [row["noticed"] if row["noticed"] is not None else float("inf") for row in of]
                if of:
                    print(f"{scene} {sensor}: {len(of)} of {len(rows)} localised before; noticed after "
                          f"{statistics.median(noticed):.1f} m (worst {max(noticed):.1f}); again after "
                          f"{statistics.median(again):.1f} m (worst {max(again):.1f}); wrong sweeps "
                          f"{sum(row['wrong'] for row in rows)}", flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps(everything, indent=1) + "\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
