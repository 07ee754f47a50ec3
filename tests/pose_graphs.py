#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Compares the minima of simulated pose graphs by `adit optimize` with those of GTSAM.

Usage: pose_graphs.py ADIT SPEED [--graphs N] [--first-seed S] [--nodes N] [--loops N]. SPEED is the program
pose_graph_speed, which writes the graphs. It needs gtsam and numpy from PyPI. Each graph is optimised in the plane by
both, with its own initial poses; a cost is the sum of chi squared, worked out here for both from the poses that they
end at. Exits 1 where adit's is above GTSAM's by more than 1e-6 of it.
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import time

try:
    import gtsam
    import numpy as np
except ImportError as error:
    print(f"pose_graphs.py: {error}; pip install gtsam numpy", file=sys.stderr)
    sys.exit(2)


def output_of(command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def read(file):
    """Poses by id, and edges: from, to, measurement, information."""
    poses, edges = {}, []
    for line in file.read_text().splitlines():
        words = line.split()
        if words and words[0] == "VERTEX_SE2":
            poses[int(words[1])] = np.array([float(word) for word in words[2:5]])
        elif words and words[0] == "EDGE_SE2":
            numbers = [float(word) for word in words[3:12]]
            information = np.zeros((3, 3))
            information[np.triu_indices(3)] = numbers[3:]
            information += np.triu(information, 1).T
            edges.append((int(words[1]), int(words[2]), np.array(numbers[:3]), information))
    return poses, edges


def between(a, b):
    """b seen from a."""
    cosine, sine = math.cos(a[2]), math.sin(a[2])
    x, y = b[0] - a[0], b[1] - a[1]
    return np.array([cosine * x + sine * y, cosine * y - sine * x, b[2] - a[2]])


def cost_of(poses, edges):
    cost = 0.0
    for start, end, measured, information in edges:
        residual = between(measured, between(poses[start], poses[end]))
        residual[2] = math.remainder(residual[2], 2.0 * math.pi)
        cost += residual @ information @ residual
    return cost


def by_gtsam(poses, edges):
    graph, initial = gtsam.NonlinearFactorGraph(), gtsam.Values()
    for node, pose in poses.items():
        initial.insert(node, gtsam.Pose2(*pose))
    for start, end, measured, information in edges:
        noise = gtsam.noiseModel.Gaussian.Information(information)
        graph.add(gtsam.BetweenFactorPose2(start, end, gtsam.Pose2(*measured), noise))
    first = min(poses)
    graph.add(gtsam.PriorFactorPose2(first, initial.atPose2(first), gtsam.noiseModel.Isotropic.Sigma(3, 1e-6)))
    parameters = gtsam.LevenbergMarquardtParams()
    parameters.setRelativeErrorTol(1e-12)
    parameters.setAbsoluteErrorTol(1e-12)
    parameters.setMaxIterations(200)
    optimizer = gtsam.LevenbergMarquardtOptimizer(graph, initial, parameters)
    found = optimizer.optimize()
    poses = {node: found.atPose2(node) for node in poses}
    return {node: np.array([pose.x(), pose.y(), pose.theta()]) for node, pose in poses.items()}, optimizer.iterations()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("adit", type=lambda path: pathlib.Path(path).absolute())
    parser.add_argument("speed", type=pathlib.Path)
    parser.add_argument("--graphs", type=int, default=5)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--nodes", type=int, default=3000)
    parser.add_argument("--loops", type=int, default=300)
    arguments = parser.parse_args()
    arguments.adit, arguments.speed = arguments.adit.resolve(), arguments.speed.resolve()
    failures = 0
    with tempfile.TemporaryDirectory() as temporary:
        file, optimized = pathlib.Path(temporary) / "graph.g2o", pathlib.Path(temporary) / "optimized.g2o"
        for seed in range(arguments.first_seed, arguments.first_seed + arguments.graphs):
            output_of([arguments.speed, "--planar", "--nodes", arguments.nodes, "--loops", arguments.loops,
                       "--seed", seed, "--write", file])
            poses, edges = read(file)
            told = json.loads(output_of([arguments.adit, "optimize", file, "-o", optimized, "--json"]))
            ours = cost_of(read(optimized)[0], edges)
            start = time.monotonic()
            theirs, iterations = by_gtsam(poses, edges)
            seconds = time.monotonic() - start
            cost = cost_of(theirs, edges)
            worse = (ours - cost) / cost
            failures += worse > 1e-6
            print(f"seed {seed}: {len(poses)} nodes, {len(edges)} edges; adit {ours:.9g} ({told['iterations']} "
                  f"iterations, {told['seconds']:.2f} s), GTSAM {cost:.9g} ({iterations} iterations, {seconds:.2f} s), "
                  f"difference {worse:.1e}", flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
