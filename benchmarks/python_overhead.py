#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""What a sweep costs more in Python than in the program, and whether the trajectories have the same bytes.

Usage: python_overhead.py ADIT RECORDING [--turns 5]. Needs the Python package adit. In turns, each in a process of its
own: `adit run` without map.ply, and the five lines of docs/python.md, without a map. A turn's figure is the median over
sweeps of the time from the end of one to that of the next, and the processor time of the whole process over its sweeps,
starting included. Printed is the least of the turns, which other programs on the machine disturb least.

Exit codes: 0 done, 1 the trajectories differ, 2 usage.
"""

import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time


def five_lines(recording, trajectory):
    """Runs in a process of its own."""
    import adit

    recording = adit.open(recording)
    slam = adit.Slam.for_recording(recording)
    placed, ends = [], []
    for sweep in slam.process(recording):
        placed.append((sweep.stamp, sweep.pose))
        ends.append(time.perf_counter())
    adit.Trajectory([stamp for stamp, _ in placed], [pose for _, pose in placed]).write(trajectory)
    print(1e3 * statistics.median(b - a for a, b in zip(ends, ends[1:])), len(ends))


def processor_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main():
    if sys.argv[1:2] == ["--five-lines"]:
        return five_lines(*sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("adit")
    parser.add_argument("recording")
    parser.add_argument("--turns", type=int, default=5)
    options = parser.parse_args()
    medians, processors = {"program": [], "Python": []}, {"program": [], "Python": []}
    with tempfile.TemporaryDirectory() as folder:
        own, theirs = pathlib.Path(folder, "out"), pathlib.Path(folder, "python.tum")
        for _ in range(options.turns):
            begin = processor_s()
            said = subprocess.run([options.adit, "run", options.recording, "-o", own, "--odometry", "--no-map", "--json"], check=True,
                                  capture_output=True, text=True)
            summary = json.loads(said.stdout)
            medians["program"].append(summary["time"]["host_ms"]["total"]["p50"])
            processors["program"].append(1e3 * (processor_s() - begin) / summary["sweeps"]["processed"])
            begin = processor_s()
            said = subprocess.run([sys.executable, __file__, "--five-lines", options.recording, theirs], check=True,
                                  capture_output=True, text=True)
            median, count = said.stdout.split()
            medians["Python"].append(float(median))
            processors["Python"].append(1e3 * (processor_s() - begin) / int(count))
            if theirs.read_bytes() != (own / "trajectory.tum").read_bytes():
                print("the trajectories differ")
                return 1
    for name, figures in medians.items():
        print(f"{name:8} {min(figures):7.2f} ms a sweep (median; turns {' '.join(f'{one:.2f}' for one in figures)}), "
              f"{min(processors[name]):7.2f} ms of processors")
    print(f"Python over program: {min(medians['Python']) / min(medians['program']):.3f}, of processors "
          f"{min(processors['Python']) / min(processors['program']):.3f}; the trajectories have the same bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
