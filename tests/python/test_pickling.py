# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Measurements, results and settings pickle and copy, to the last bit."""

import copy
import math
import pickle
import random

import numpy as np
import pytest

import adit

# They hold a device or a file.
NOT_PICKLED = {adit.Device, adit.Aligner, adit.Odometry, adit.Slam, adit.Recording, adit.Map, adit.EventIterator,
               adit.PlacedSweeps}
# The test recording has none of them.
NOT_SEEN = {adit.Loop, adit.DoubtfulStretch, adit.ReferencePose}


def content(value):
    """What can be read of an object, to compare it."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, (list, tuple)):
        return [content(one) for one in value]
    if isinstance(value, dict):
        return {key: content(one) for key, one in value.items()}
    if isinstance(value, float) and math.isnan(value):
        return "nan"
    if isinstance(value, adit.Config):
        return value.to_toml()
    if type(value).__module__.startswith("adit"):
        return {name: content(getattr(value, name)) for name, member in vars(type(value)).items()
                if isinstance(member, property)}
    return value


def first(objects, kind):
    return next(one for one in objects if isinstance(one, kind))


def far_sweep(folder):
    """A sweep with an offset: its coordinates are too large for float32."""
    points = "".join(f"{500000.123 + 0.257 * i} {5400000.456 - i} {i}\n" for i in range(3))
    (folder / "far.ply").write_text("ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
                                    "property double z\nend_header\n" + points)
    sweep = first(adit.open(folder / "far.ply"), adit.Sweep)
    assert np.abs(sweep.offset).max() > 1e6
    return sweep


@pytest.fixture(scope="module")
def objects(drive, mapped, room, tmp_path_factory):
    """An object or more of every class that pickles."""
    folder = tmp_path_factory.mktemp("pickling")
    file, report, placed = mapped
    recording = adit.open(drive)
    events = list(recording)
    slam = adit.Slam(recording.config, inertial=True, high_rate_smoothing=0.05)
    results = [one for event in events for one in slam.add(event)]
    sweeps = [event for event in events if isinstance(event, adit.Sweep)]
    backwards = adit.Slam(inertial=False)
    motion = first((one.motion for one in results if isinstance(one, adit.ReadingTaken)), adit.LidarMotion)
    left_out = [*backwards.add(sweeps[1]), *backwards.add(sweeps[0])]
    map_ = adit.Map(file)
    trajectory = map_.trajectory()
    evaluation = adit.evaluate(trajectory, drive.with_name("drive.truth.tum"))
    plane = np.random.default_rng(1).uniform(-10.0, 10.0, (5000, 3))
    plane[:, 2] = -1.0
    alignments = adit.align_batch([(room(np.eye(4)), room(np.eye(4)), np.eye(4)), (plane, plane, np.eye(4))])
    last = placed[-1].result
    return [
        *events[:40], sweeps[0], far_sweep(folder), adit.Sweep(plane[:3], [0.0, 0.1, 0.2], stamp=5, rings=[1, 2, 3],
                                                               doppler=[1.0, math.nan, -1.0], frame="lidar"),
        first(events, adit.GnssFix), adit.BodyVelocity(7, [1.0, math.nan, 0.0], np.eye(3), frame="wheels"),
        adit.Heading(7, 0.5, 0.02, frame="antenna"),
        *results[-20:], motion, *left_out, placed[0], placed[-1], last, last.registration, *last.registration.translation, last.inertial, report,
        slam.verdict, *map_.sessions, *map_.keyframes, *map_.edges, *map_.fixes, map_.submap(0), map_.georeference,
        trajectory, evaluation, evaluation.ate, *alignments, *recording.topics, adit.estimate_surfaces(plane, 0.5),
        adit.Config(preset="kitti-raw"), adit.Config(), adit.simulate("room", folder / "room.mcap", duration=0.2)]


def test_what_is_unpickled_and_copied_is_the_same(objects):
    for one in objects:
        expected = content(one)
        assert expected, one
        for again in (pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one)):
            assert type(again) is type(one) and content(again) == expected, one


def test_every_class_pickles_but_those_that_hold_a_device_or_a_file(objects):
    classes = {value for value in vars(adit).values() if isinstance(value, type) and value.__module__ == "adit._adit"}
    assert {type(one) for one in objects} == classes - NOT_PICKLED - NOT_SEEN
    for one in classes - NOT_PICKLED:
        assert "__setstate__" in vars(one), one
    with pytest.raises(TypeError, match="cannot pickle"):
        pickle.dumps(adit.Odometry())


def test_views_of_an_unpickled_object_keep_it_alive():
    points = pickle.loads(pickle.dumps(adit.Sweep(np.ones((5, 3))))).points
    assert np.array_equal(points[:, :3], np.ones((5, 3))) and not points.flags.writeable


def unpickled(kind, state):
    one = kind.__new__(kind)
    one.__setstate__(state)
    return one


def test_damaged_states_raise(objects):
    dice = random.Random(3)
    tried = 0
    for one in objects[::7]:
        version, state = one.__getstate__()
        if isinstance(one, adit.Config):  # a text, with the checks of a file
            continue
        for damaged in (state[:-1], state + b"0"):
            with pytest.raises(ValueError, match="damaged"):
                unpickled(type(one), (version, damaged))
        for _ in range(20):
            damaged = bytearray(state)
            for _ in range(dice.randint(1, 8)):
                damaged[dice.randrange(len(damaged))] = dice.randrange(256)
            tried += 1
            try:  # either is right, a crash is not
                unpickled(type(one), (version, bytes(damaged)))
            except ValueError as error:
                assert "damaged" in str(error)
    assert tried > 200
    with pytest.raises(ValueError, match="none of adit's"):
        unpickled(adit.Sweep, ("1",))
    with pytest.raises(ValueError, match="pickled by adit 0.0.1, this is "):
        unpickled(adit.Sweep, ("0.0.1", b""))
