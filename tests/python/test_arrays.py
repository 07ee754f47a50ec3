# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Clouds, poses and times may be arrays of any number type and layout, or lists; the results are the same bits."""

import pickle

import numpy as np
import pytest

import adit

CLOUD = np.random.default_rng(7).integers(-40, 40, (600, 4)).astype(np.float32) / 8.0  # exact in float16, too


def structured(cloud):
    """Rows of 17 bytes, as packed messages have them: neither contiguous nor aligned."""
    packed = np.zeros(len(cloud), [("xyzi", "<f4", 4), ("tag", "u1")])
    packed["xyzi"] = cloud
    return packed["xyzi"]


WAYS = {
    "unpickled": lambda cloud: pickle.loads(pickle.dumps(cloud)),
    "unpickled float64": lambda cloud: pickle.loads(pickle.dumps(cloud.astype(np.float64))),
    "list": lambda cloud: cloud.tolist(),
    "tuple of arrays": lambda cloud: tuple(cloud),
    "float16": lambda cloud: cloud.astype(np.float16),
    "big-endian float32": lambda cloud: cloud.astype(">f4"),
    "big-endian float64": lambda cloud: cloud.astype(">f8"),
    "Fortran order": np.asfortranarray,
    "every second row": lambda cloud: np.repeat(cloud, 2, axis=0)[::2],
    "backwards twice": lambda cloud: cloud[::-1].copy()[::-1],
    "unaligned": structured,
    "read-only": lambda cloud: np.frombuffer(cloud.tobytes(), np.float32).reshape(cloud.shape),
    "memory": memoryview,
    "long double": lambda cloud: cloud.astype(np.longdouble),
}


@pytest.mark.parametrize("way", WAYS)
def test_every_layout_of_a_cloud_is_taken(way):
    assert np.array_equal(adit.Sweep(WAYS[way](CLOUD)).points, CLOUD)
    if way != "unaligned":
        assert np.array_equal(adit.Sweep(WAYS[way](np.ascontiguousarray(CLOUD[:, :3]))).points[:, :3], CLOUD[:, :3])


@pytest.mark.parametrize("kind", [np.int8, np.uint8, np.int16, ">i4", np.int64, np.uint64])
def test_whole_numbers_are_coordinates(kind):
    cloud = np.random.default_rng(8).integers(0, 100, (50, 3))
    assert np.array_equal(adit.Sweep(cloud.astype(kind)).points[:, :3], cloud)
    assert np.array_equal(adit.Sweep(cloud.tolist()).points[:, :3], cloud)


def test_what_is_given_is_copied():
    cloud = CLOUD.copy()
    sweep = adit.Sweep(cloud)
    cloud[:] = 0.0
    assert np.array_equal(sweep.points, CLOUD)


def test_times_rings_and_poses():
    for times in ([0.0, 0.5], np.array([0, 0.5], np.float16), np.array([0, 0.5], ">f8")):
        assert np.array_equal(adit.Sweep(CLOUD[:2], times).times, np.array([0.0, 0.5], np.float32))
    for rings in ([3, 65535], np.array([3, 65535], np.uint16), np.array([3, 65535], ">i8")):
        assert np.array_equal(adit.Sweep(CLOUD[:2], rings=rings).rings, np.array([3, 65535]))
    with pytest.raises(ValueError, match="rings: 65536 is not between 0 and 65535"):
        adit.Sweep(CLOUD[:2], rings=[0, 65536])
    with pytest.raises(TypeError, match="rings: whole numbers are expected, not float64"):
        adit.Sweep(CLOUD[:2], rings=np.zeros(2))
    pose = [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]]
    assert np.array_equal(adit.StaticTransform("a", "b", pose).T_parent_child, np.array(pose))
    assert np.array_equal(adit.StaticTransform("a", "b", np.array(pose, ">f4")).T_parent_child, np.array(pose))
    assert np.array_equal(adit.GnssFix(0, 47.0, 8.0, 500.0, [[1, 0, 0], [0, 2, 0], [0, 0, 3]]).covariance,
                          np.diag([1.0, 2.0, 3.0]))
    trajectory = pickle.loads(pickle.dumps((np.arange(2), np.stack([np.eye(4)] * 2))))
    assert len(adit.Trajectory(*trajectory)) == 2 == len(adit.Trajectory([0, 1], [pose, pose]))


def test_align_takes_them(room):
    a, b = room(np.eye(4)), room(np.eye(4))
    expected = adit.align(a, b, np.eye(4)).T_a_b
    guess = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    assert np.array_equal(adit.align(*pickle.loads(pickle.dumps((a, b, np.eye(4))))).T_a_b, expected)
    assert np.array_equal(adit.align(a.astype(">f4"), b.tolist(), guess).T_a_b, expected)
    assert np.array_equal(adit.align_batch([(a.tolist(), np.asfortranarray(b), guess)])[0].T_a_b, expected)


@pytest.mark.parametrize("points, error, message", [
    (np.ones((5, 3), complex), TypeError, "points: numbers are expected, not complex128"),
    (np.ones((5, 3), bool), TypeError, "points: numbers are expected, not bool"),
    (np.ones((5, 3), object), TypeError, "points: numbers are expected, not object"),
    (np.zeros(5, [("x", "f4"), ("y", "f4")]), TypeError, "points: numbers are expected, not "),
    ([["1", "2", "3"]], TypeError, "points: an array or list of numbers is expected, not list"),
    (None, TypeError, "points: an array or list of numbers is expected, not NoneType"),
    (object(), TypeError, "not object"),
    ([[1.0, 2.0, 3.0], [4.0]], ValueError, "points: the rows of this list differ in length"),
    ([], ValueError, r"points: has the shape \(0,\)"),
    (5.0, ValueError, r"points: has the shape \(\)"),
])
def test_what_holds_no_numbers_is_refused(points, error, message):
    with pytest.raises(error, match=message):
        adit.Sweep(points)
