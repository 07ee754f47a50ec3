# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python package share. ADIT_PROGRAM is the program that the package is compared with."""

import os
import pathlib
import subprocess

import numpy as np
import pytest

import adit

PACKAGE = pathlib.Path(adit.__file__).parent
# For other processes to find the package that is tested: installed, or in a build tree.
PATHS = {} if PACKAGE.parent.name.endswith("-packages") else {
    "PYTHONPATH": str(PACKAGE.parent), "MYPYPATH": str(PACKAGE.parent)}
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SHARED = ROOT.parent / "shared" / "data"


@pytest.fixture(scope="session")
def program():
    """Runs the program with these arguments; what it prints."""
    file = os.environ["ADIT_PROGRAM"]

    def run(*arguments):
        answer = subprocess.run([file, *map(str, arguments)], capture_output=True, text=True, timeout=500)
        assert answer.returncode == 0, answer.stdout + answer.stderr
        return answer.stdout

    return run


@pytest.fixture(scope="session")
def drive(tmp_path_factory):
    """A small recording with an IMU and GNSS, and its ground truth beside it."""
    file = tmp_path_factory.mktemp("drive") / "drive.mcap"
    adit.simulate("city", file, sensor="VLP-16", duration=4.0, seed=5, gnss="rtk")
    return file


@pytest.fixture(scope="session")
def mapped(drive, tmp_path_factory):
    """The map of that recording, as Slam makes it, and its report."""
    file = tmp_path_factory.mktemp("map") / "drive.adit"
    recording = adit.open(drive)
    slam = adit.Slam.for_recording(recording, map=file)
    placed = list(slam.process(recording))
    return file, slam.finish_map(), placed


@pytest.fixture(scope="session")
def room():
    """A sweep of a room that is open on two sides, (n, 4) float32, as it is seen from a pose."""
    random = np.random.default_rng(3)

    def seen_from(pose):
        walls = []
        for axis, place in ((0, -6.0), (1, -4.0), (2, -1.5), (2, 2.5)):
            wall = random.uniform((-6.0, -4.0, -1.5), (8.0, 5.0, 2.5), (4000, 3))
            wall[:, axis] = place
            walls.append(wall)
        for i in range(6):  # boxes from the floor up, each elsewhere and of another size
            lower = np.array([(-4.5, -2.5), (-3.0, 3.0), (0.5, -3.5), (2.0, 1.5), (4.5, -2.0), (6.0, 3.2)][i])
            size = 0.5 + 0.2 * i
            for axis in range(4):
                side = random.uniform((*lower, -1.5), (*(lower + size), 0.2 * i + 0.2), (900, 3))
                side[:, axis % 2] = lower[axis % 2] + (size if axis > 1 else 0.0)
                walls.append(side)
        world = np.concatenate(walls)
        local = (world - pose[:3, 3]) @ pose[:3, :3]
        return np.concatenate([local, np.ones((len(local), 1))], axis=1).astype(np.float32)

    return seen_from
