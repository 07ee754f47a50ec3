# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Clouds: alignment, down-sampling, surfaces."""

import numpy as np
import pytest

import adit
from conftest import SHARED


def pose_of(x, y, z, yaw):
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    pose[:3, 3] = x, y, z
    return pose


def off(found, truth):
    """Distance (m) and angle (rad) between two poses."""
    between = np.linalg.inv(found) @ truth
    return np.linalg.norm(between[:3, 3]), np.arccos(np.clip((np.trace(between[:3, :3]) - 1.0) / 2.0, -1.0, 1.0))


def test_a_pose_is_found_from_a_guess_and_from_nothing(room):
    truth = pose_of(0.7, -0.4, 0.1, 0.3)
    a, b = room(np.eye(4)), room(truth)
    for guess in (np.eye(4), None):
        alignment = adit.align(a, b, guess)
        assert alignment.usable and alignment.refusal is None and alignment.reason is None
        distance, angle = off(alignment.T_a_b, truth)
        assert distance < 0.02 and angle < 0.005
        assert alignment.covariance.shape == (6, 6) and alignment.registration.overlap > 0.9
    assert "usable" in repr(alignment)


def test_a_pose_that_cannot_be_vouched_for_is_refused(room):
    plane = np.random.default_rng(1).uniform(-10.0, 10.0, (5000, 3))
    plane[:, 2] = -1.0
    alignment = adit.align(plane, plane, np.eye(4))
    assert not alignment.usable and alignment.refusal == "degenerate"
    assert "held not along" in alignment.reason or "degenerate" in alignment.reason
    few = adit.align(plane[:50], room(np.eye(4)))
    assert few.refusal == "nothing_to_align" and "fewer than 100 points" in few.reason


def test_a_batch_gives_what_its_pairs_give(room):
    poses = [pose_of(0.3 * i, -0.2 * i, 0.0, 0.1 * i) for i in range(3)]
    clouds = [room(pose) for pose in poses]
    pairs = [(clouds[0], clouds[1], np.eye(4)), (clouds[0], clouds[2]), (clouds[1], clouds[2], None)]
    for pair, alignment in zip(pairs, adit.align_batch(pairs)):
        assert np.array_equal(alignment.T_a_b, adit.align(*pair).T_a_b)
    assert adit.align_batch([]) == []
    with pytest.raises(ValueError, match=r"pairs\[1\]: \(a, b\) or \(a, b, guess\) is expected"):
        adit.align_batch([pairs[0], (clouds[0],)])
    with pytest.raises(TypeError, match=r"pairs\[0\]\[1\]: an array or list of numbers"):
        adit.align_batch([(clouds[0], "cloud")])
    with pytest.raises(ValueError, match="method: one of vgicp, ndt"):
        adit.Aligner(method="icp")
    with pytest.raises(ValueError, match="min_overlap"):
        adit.Aligner(min_overlap=2.0)


def test_a_recorded_pair(program):
    folder = SHARED / "registration_pair"
    if not folder.exists():
        pytest.skip("needs ../shared/data/registration_pair")
    target, source = (next(iter(adit.open(folder / name).events())).points for name in ("target.ply", "source.ply"))
    truth = np.loadtxt(folder / "T_target_source.txt").reshape(4, 4)
    distance, angle = off(adit.align(target, source).T_a_b, truth)
    assert distance < 0.1 and angle < 0.01


def test_down_sampling_takes_the_centroid_of_each_voxel():
    points = np.random.default_rng(2).uniform(-5.0, 5.0, (4000, 4)).astype(np.float32)
    found = adit.voxel_down_sample(points, 0.5)
    voxels = {}
    for point in points.astype(np.float64):
        voxels.setdefault(tuple(np.floor(point[:3] / 0.5)), []).append(point[:3])
    expected = np.array(sorted(np.mean(voxel, axis=0).tolist() for voxel in voxels.values()))
    assert found.dtype == np.float32 and len(found) == len(expected)
    np.testing.assert_allclose(np.array(sorted(found[:, :3].tolist())), expected, atol=2e-3)
    assert np.array_equal(found, adit.voxel_down_sample(points, 0.5))
    with pytest.raises(ValueError, match="size: is 0.001; must be between"):
        adit.voxel_down_sample(points, 0.001)
    with pytest.raises(ValueError, match="points: lie up to 5000 m from the origin"):
        adit.voxel_down_sample(np.array([[5000.0, 0.0, 0.0]]), 0.5)


def test_surfaces_of_planes_have_their_normals():
    points = np.random.default_rng(4).uniform(-5.0, 5.0, (20000, 3))
    points[:, 2] = -2.0
    surfaces = adit.estimate_surfaces(points, 0.25)
    assert surfaces.planes.dtype == bool and surfaces.planes.mean() > 0.95
    np.testing.assert_allclose(np.abs(surfaces.directions[surfaces.planes, 2]), 1.0, atol=1e-3)
    assert surfaces.points.shape == (len(surfaces), 4) and surfaces.directions.shape == (len(surfaces), 3)
