#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How long adit, small_gicp and KISS-ICP take for a sweep of the same recording, in turns.

Usage: speed_peers.py ADIT RECORDING [--turns 5] [--threads 2] [--sweeps N]. RECORDING: a folder with velodyne/*.bin
or velodyne_points/data/*.bin (KITTI), or an MCAP file of `adit simulate`. Of each turn: the wall time from before the
first sweep is read to behind the last pose, over the sweeps, without what starting takes (kernels, imports). Then the
median of the turns, its ratio to small_gicp's, and the spread.

small_gicp: VGICP odometry against a local model, as its own benchmark has it: down-sampled to 0.25 m, covariances of
10 neighbours, voxels of 1 m, least recently used ones dropped. KISS-ICP: its defaults. adit: its defaults, without
map.ply, on the device that it chooses or ADIT_DEVICE names; LP_NUM_THREADS is set for software ones.

Exit codes: 0 done, 1 a system failed, 2 usage.
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


def kitti_files(folder):
    for inner in ("velodyne", "velodyne_points/data", "."):
        files = sorted((folder / inner).glob("*.bin"))
        if files:
            return files
    raise SystemExit(f"speed_peers.py: {folder}: neither velodyne/*.bin nor velodyne_points/data/*.bin is there")


def sweeps(recording, most):
    """Points (m) of each sweep, and their times or nothing; read as it is asked for."""
    if recording.is_dir():
        for file in kitti_files(recording)[:most]:
            yield np.fromfile(file, np.float32).reshape(-1, 4)[:, :3].astype(float), None
        return
    from peers import sweeps as messages  # which needs the package mcap

    for number, (_, points, times) in enumerate(messages(recording)):
        if number == most:
            return
        yield points, times


def run_adit(program, recording, threads, most):
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", str(recording), "-o", folder + "/out", "--odometry", "--no-map", "--json"]
        if most:
            command += ["--count", str(most)]
        environment = {**os.environ, "LP_NUM_THREADS": str(threads)}
        result = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        if result.returncode != 0:
            raise RuntimeError(f"{' '.join(command)}: {result.stderr.strip()[-500:]}")
        summary = json.loads(result.stdout)
        return summary["time"]["wall_s"], summary["sweeps"]["processed"], summary["device"]["name"]


def run_small_gicp(recording, threads, most):
    import small_gicp

    start = time.perf_counter()
    local_map = small_gicp.GaussianVoxelMap(1.0)
    pose, step, count = np.eye(4), np.eye(4), 0
    for points, _ in sweeps(recording, most):
        cloud, _ = small_gicp.preprocess_points(points, 0.25, num_neighbors=10, num_threads=threads)
        if count > 0:
            result = small_gicp.align(local_map, cloud, pose @ step, num_threads=threads)
            step = np.linalg.inv(pose) @ result.T_target_source
            pose = result.T_target_source
        local_map.insert(cloud, pose)
        count += 1
    return time.perf_counter() - start, count


def run_kiss_icp(recording, threads, most):
    from kiss_icp.config import KISSConfig
    from kiss_icp.config.parser import load_config
    from kiss_icp.kiss_icp import KissICP

    config = load_config(None) if load_config else KISSConfig()
    config.registration.max_num_threads = threads
    system, count = KissICP(config), 0
    start = time.perf_counter()
    for points, times in sweeps(recording, most):
        if times is None:
            offsets = np.zeros(0)
        else:
            offsets = (times - times.min()) / max(1, int(times.max() - times.min()))
        system.register_frame(points, offsets.astype(float))
        count += 1
    return time.perf_counter() - start, count


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("adit", help="the program")
    parser.add_argument("recording", type=pathlib.Path)
    parser.add_argument("--turns", type=int, default=5)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--sweeps", type=int, default=None, help="no more than these")
    parser.add_argument("--systems", nargs="+", default=["adit", "small_gicp", "kiss-icp"])
    arguments = parser.parse_args()
    if not arguments.recording.exists():
        parser.error(f"{arguments.recording}: no such file or folder")
    sys.path.insert(0, str(pathlib.Path(__file__).parent))
    device, took, failed = "", {}, False
    for turn in range(arguments.turns):
        for system in list(arguments.systems):
            try:
                if system == "adit":
                    seconds, count, device = run_adit(arguments.adit, arguments.recording, arguments.threads,
                                                      arguments.sweeps)
                else:
                    run = {"small_gicp": run_small_gicp, "kiss-icp": run_kiss_icp}[system]
                    seconds, count = run(arguments.recording, arguments.threads, arguments.sweeps)
            except (ImportError, RuntimeError, KeyError) as error:
                print(f"{system}: {error}", file=sys.stderr)
                arguments.systems.remove(system)
                failed = True
                continue
            took.setdefault(system, []).append(1e3 * seconds / max(count, 1))
            print(f"turn {turn + 1}: {system:12} {took[system][-1]:8.2f} ms a sweep, {count} sweeps", flush=True)
    peer = statistics.median(took["small_gicp"]) if took.get("small_gicp") else None
    print(f"\n{arguments.threads} threads; adit on {device}")
    print(f"{'ms a sweep':12} {'median':>8} {'least':>8} {'most':>8}  of small_gicp")
    for system, values in took.items():
        middle = statistics.median(values)
        ratio = f"{middle / peer:.2f}" if peer else "-"
        print(f"{system:12} {middle:8.2f} {min(values):8.2f} {max(values):8.2f}  {ratio}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
