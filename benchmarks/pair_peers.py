#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""What down-sampling, a pair of raw clouds, and batches of pairs cost, beside small_gicp, in turns.

Usage: pair_peers.py ADIT FOLDER [--turns 5] [--threads 2] [--pairs 64]. FOLDER has velodyne/*.bin (KITTI).

- down-sampling: the first sweep to 0.25 m. adit: case `downsample` of `adit bench` by the device's clock, which also
  sums up what surfaces are estimated from.
- preparing: the same with surfaces, small_gicp's covariances of 10 neighbours. adit: case `preprocess` on the host's
  clock, upload and read-back included.
- pair to pose: the first two sweeps as they are to their relative pose, by VGICP with voxels of 1 m. adit: case
  `pipeline/vgicp`. small_gicp: `align` with down-sampling to 0.25 m and covariances of 10 neighbours.
- a batch: poses of pairs of clouds that are ready, with surfaces and voxels of 1 m, guesses some 0.3 m and 2 degrees
  off. adit: case `batch/vgicp` on its simulated submaps (34 000 points); small_gicp: a loop over pairs of sweeps that
  are down-sampled to about as many points.

Medians of the turns, in ms (of a batch: ms a pair), and their ratio. Exit codes: 0 done, 1 a system failed, 2 usage.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

from speed_peers import kitti_files

METHOD = "vgicp".upper()
BATCH_VOXEL_M = 0.18  # leaves some 34 000 points of an HDL-64E's sweep


def ms_of(call, runs):
    took = []
    for _ in range(runs):
        start = time.perf_counter()
        call()
        took.append(1e3 * (time.perf_counter() - start))
    return statistics.median(took)


def adit_ms(program, files, threads, pairs):
    """Case: ms."""
    environment = {**os.environ, "LP_NUM_THREADS": str(threads)}
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        clouds = []
        for i, file in enumerate(files):
            clouds.append(f"{folder}/{i}.ply")
            points = np.fromfile(file, np.float32).reshape(-1, 4)
            header = ("ply\nformat binary_little_endian 1.0\n" + f"element vertex {len(points)}\n" +
                      "".join(f"property float {name}\n" for name in ("x", "y", "z", "intensity")) + "end_header\n")
            pathlib.Path(clouds[-1]).write_bytes(header.encode() + points.tobytes())
        for words in (["downsample", "preprocess", "pipeline/vgicp", "--input", *clouds], ["batch/vgicp", "--batches", str(pairs)]):
            file = folder + "/bench.json"
            command = [program, "bench", *words, "--no-peers", "--json", file]
            result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
            if result.returncode != 0:
                raise RuntimeError(f"{' '.join(command)}: {result.stdout}{result.stderr}")
            for row in json.loads(pathlib.Path(file).read_text())["rows"]:
                clock = "device_ms" if row["name"] == "downsample" else "host_ms"
                found[row["name"]] = row[clock]["median"]
    return {"down-sampling": found["downsample"], "preparing": found["preprocess"], "pair to pose": found["pipeline/vgicp"],
            "a pair of a batch": found["batch/vgicp"] / pairs}


def small_gicp_ms(files, threads, pairs):
    import small_gicp

    sweeps = [np.fromfile(file, np.float32).reshape(-1, 4)[:, :3].astype(float) for file in files]
    random = np.random.default_rng(1)
    ready = [small_gicp.preprocess_points(sweep, BATCH_VOXEL_M, num_neighbors=10, num_threads=threads)[0]
             for sweep in sweeps]
    voxels = []
    for cloud in ready:
        voxels.append(small_gicp.GaussianVoxelMap(1.0))
        voxels[-1].insert(cloud, np.eye(4))
    guesses = []
    for _ in range(pairs):
        guess = np.eye(4)
        turn = random.normal() * np.radians(1.0)
        guess[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        guess[:3, 3] = random.normal(size=3) * 0.15
        guesses.append(guess)

    def batch():
        for i, guess in enumerate(guesses):
            small_gicp.align(voxels[i % 2], ready[(i + 1) % 2], guess, num_threads=threads)

    return {
        "down-sampling": ms_of(lambda: small_gicp.voxelgrid_sampling(sweeps[0], 0.25, num_threads=threads), 30),
        "preparing": ms_of(lambda: small_gicp.preprocess_points(sweeps[0], 0.25, num_neighbors=10, num_threads=threads),
                           20),
        "pair to pose": ms_of(lambda: small_gicp.align(sweeps[0], sweeps[1], registration_type=METHOD,
                                                       voxel_resolution=1.0, downsampling_resolution=0.25,
                                                       num_threads=threads), 20),
        "a pair of a batch": ms_of(batch, 3) / pairs,
    }, [cloud.size() for cloud in ready]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("adit", help="the program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--pairs", type=int, default=64)
    arguments = parser.parse_args()
    if not arguments.folder.is_dir():
        parser.error(f"{arguments.folder}: no such folder")
    files = kitti_files(arguments.folder)[:2]
    ours, peers = [], []
    for turn in range(arguments.turns):
        try:
            ours.append(adit_ms(arguments.adit, files, arguments.threads, arguments.pairs))
            figures, sizes = small_gicp_ms(files, arguments.threads, arguments.pairs)
        except (ImportError, RuntimeError, KeyError) as error:
            print(f"pair_peers.py: {error}", file=sys.stderr)
            return 1
        peers.append(figures)
        print(f"turn {turn + 1}: " + "; ".join(f"{name} {ours[-1][name]:.2f} and {peers[-1][name]:.2f} ms"
                                               for name in figures), flush=True)
    print(f"\n{arguments.threads} threads; small_gicp's batch has clouds of {sizes[0]} and {sizes[1]} points")
    print(f"{'ms':18} {'adit':>8} {'small_gicp':>11}  ratio")
    for name in peers[0]:
        a, b = (statistics.median(turn[name] for turn in system) for system in (ours, peers))
        print(f"{name:18} {a:8.2f} {b:11.2f}  {a / b:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
