#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Installs a build, and compiles docs/examples/ against what was installed alone, by CMake and by pkg-config.

Usage: installed.py BUILD FOLDER. Each example runs on data whose answer is known; what it prints is shown, and exit 1 with
the first one that is wrong.
"""

import math
import os
import pathlib
import random
import re
import shutil
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "docs" / "examples"
FLAGS = ["-O1", "-Wall", "-Werror"]
STEP = (0.05, 0.02)  # m that the sensor moves from one sweep to the next


def run(*command, env=None, shown=False):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, env=env, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    if shown:
        print(f"--- {pathlib.Path(command[0]).name}\n{done.stdout}", end="")
    return done.stdout


def wall(point, along, height, count, rng):
    """Points of an upright rectangle."""
    return [(point[0] + a * along[0], point[1] + a * along[1], rng.uniform(-1.2, height - 1.2))
            for a in (rng.random() for _ in range(count))]


def sweep_from(x, y, seed):
    """What a sensor at (x, y) sees of an L-shaped room with a pillar, by float32 x, y, z, intensity."""
    rng = random.Random(seed)
    corners = [(-4, -3), (6, -3), (6, 1), (1, 1), (1, 5), (-4, 5)]
    points = []
    for here, there in zip(corners, corners[1:] + corners[:1]):
        points += wall(here, (there[0] - here[0], there[1] - here[1]), 2.8, 1500, rng)
    points += [(3 + 0.3 * math.cos(a), -1 + 0.3 * math.sin(a), rng.uniform(-1.2, 1.6))
               for a in (rng.uniform(0, 2 * math.pi) for _ in range(600))]
    points += [(rng.uniform(-4, 6), rng.uniform(-3, 1), z) for z in (-1.2, 1.6) for _ in range(2000)]
    points += [(rng.uniform(-4, 1), rng.uniform(1, 5), z) for z in (-1.2, 1.6) for _ in range(2000)]
    return b"".join(struct.pack("<4f", p[0] - x + rng.gauss(0, 0.01), p[1] - y + rng.gauss(0, 0.01),
                                p[2] + rng.gauss(0, 0.01), 1.0) for p in points)


def write_sweeps(folder, count):
    files = []
    for i in range(count):
        files.append(folder / f"{i:06d}.bin")
        files[-1].write_bytes(sweep_from(i * STEP[0], i * STEP[1], i))
    return files


def require(condition, what, output):
    if not condition:
        sys.exit(f"{what}:\n{output}")


def near(found, expected, tolerance):
    return all(abs(a - b) <= tolerance for a, b in zip(found, expected))


def numbers(text):
    return [float(word) for word in re.findall(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?", text)]


def check_examples(programs, files, recording, mapped):
    output = run(programs["odometry"], *files, shown=True)
    lines = output.splitlines()
    require(len(lines) == len(files), "odometry: not every sweep was placed", output)
    last = numbers(lines[-1].split(": ", 1)[1])[:3]
    steps = len(files) - 1
    require(near(last, (steps * STEP[0], steps * STEP[1], 0), 0.02), "odometry: ends elsewhere", output)

    output = run(programs["align_pair"], files[0], files[-1], shown=True)
    rows = [numbers(line) for line in output.splitlines()[1:4]]
    require(near([row[3] for row in rows], (steps * STEP[0], steps * STEP[1], 0), 0.02), "align_pair: another pose", output)

    output = run(programs["align_batch"], *files[:4], shown=True)
    for line in output.splitlines():
        require(line.endswith(" none") and near(numbers(line.split(": ", 1)[1])[:2], STEP, 0.02),
                "align_batch: another pose", output)
    require(len(output.splitlines()) == 3, "align_batch: not every pair", output)

    output = run(programs["own_kernel"], shown=True)
    require(near(numbers(output)[-1:], [99.9999], 0.001), "own_kernel: another range", output)

    output = run(programs["read_recording"], recording, shown=True)
    require(re.search(r"\(sweeps\): \d\d events", output) and "(imu): " in output, "read_recording: topics", output)

    output = run(programs["map_recording"], recording, shown=True)
    require(len(output.splitlines()) >= 20, "map_recording: few sweeps", output)

    # Away from the sensor, until it comes to a wall.
    outputs = [run(programs["query_map"], mapped, x, 0, 0) for x in range(1, 9)]
    found = [output for output in outputs if re.search(r": [1-9]\d* of its", output)]
    require(found and re.search(r"^[1-9]\d* keyframes", found[0]), "query_map: nothing there", outputs)
    print(f"--- query_map\n{found[0]}", end="")


def main():
    build, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    shutil.rmtree(folder, ignore_errors=True)
    prefix, data = folder / "prefix", folder / "data"
    data.mkdir(parents=True)
    run("cmake", "--install", build, "--prefix", prefix)

    by_cmake = folder / "by_cmake"
    run("cmake", "-S", EXAMPLES, "-B", by_cmake, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
        f"-DCMAKE_CXX_FLAGS={' '.join(FLAGS)}")
    run("cmake", "--build", by_cmake)

    by_hand = folder / "by_hand"
    by_hand.mkdir()
    env = os.environ | {"PKG_CONFIG_PATH": ":".join(map(str, prefix.glob("**/pkgconfig")))}
    flags = run("pkg-config", "--cflags", "--libs", "adit", env=env).split()
    sources = sorted(EXAMPLES.glob("*.cpp"))
    for source in sources:
        run("g++", *FLAGS, f"-I{by_cmake}", source, "-o", by_hand / source.stem, *flags)

    adit = prefix / "bin" / "adit"
    recording = data / "room.mcap"
    run(adit, "simulate", "room", "--sensor", "VLP-16", "--duration", 3, "-o", recording)
    run(adit, "run", recording, "-o", data / "out", "--quiet")
    files = write_sweeps(data, 10)
    for where in (by_cmake, by_hand):
        print(f"=== {where.name}")
        check_examples({source.stem: where / source.stem for source in sources}, files, recording,
                       data / "out" / "map.adit")


if __name__ == "__main__":
    main()
