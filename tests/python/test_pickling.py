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

NONE = [adit.Device, adit.Aligner, adit.Odometry, adit.Slam, adit.Recording, adit.Map, adit.EventIterator,
        adit.PlacedSweeps]  # hold a device or a file


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
    if type(value).__module__.startswith("adit"):
        return {name: content(getattr(value, name)) for name, member in vars(type(value)).items()
                if isinstance(member, property)}
    return value


@pytest.fixture(scope="module")
def objects(drive, mapped, room):
    """An object or more of every class that pickles."""
    file, report, placed = mapped
    recording = adit.open(drive)
    events = list(recording)
    slam = adit.Slam(recording.config, inertial=True, high_rate_smoothing=0.05)
    results = [one for event in events if not isinstance(event, adit.ReferencePose) for one in slam.add(event)]
    left_out = adit.Slam(inertial=False)
    left_out.add(events[-1] if isinstance(events[-1], adit.Sweep) else next(
        event for event in events if isinstance(event, adit.Sweep)))
    again = left_out.add(next(event for event in events if isinstance(event, adit.Sweep))) + left_out.flush()
    map_ = adit.Map(file)
    trajectory = map_.trajectory()
    truth = drive.with_name("drive.truth.tum")
    poses = next(topic.name for topic in recording.topics if topic.kind == "poses") if any(
        topic.kind == "poses" for topic in recording.topics) else None
    evaluation = adit.evaluate(trajectory, truth)
    plane = np.random.default_rng(1).uniform(-10.0, 10.0, (5000, 3))
    plane[:, 2] = -1.0
    alignments = adit.align_batch([(room(np.eye(4)), room(np.eye(4)), np.eye(4)), (plane, plane, np.eye(4))])
    found = [*events[:40], *results[-20:], *again, placed[0], placed[-1], placed[-1].result,
             placed[-1].result.registration, *placed[-1].result.registration.translation, placed[-1].result.inertial,
             report, slam.verdict, *map_.sessions, *map_.keyframes, *map_.edges, *map_.loops, *map_.fixes,
             map_.submap(0), trajectory, evaluation, evaluation.ate, *alignments, *recording.topics,
             adit.estimate_surfaces(plane, 0.5), adit.Config(preset="kitti-raw"), adit.Config(),
             next(one.motion for one in results if isinstance(one, adit.ReadingTaken) and one.motion)]
    if map_.georeference:
        found.append(map_.georeference)
    if poses:
        found.append(next(iter(recording.events([poses]))))
    return found


def test_what_is_unpickled_and_copied_is_the_same(objects):
    for one in objects:
        expected = content(one)
        for again in (pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one)):
            assert type(again) is type(one) and content(again) == expected, one
    assert pickle.loads(pickle.dumps(adit.Config(preset="kitti-raw"))) == adit.Config(preset="kitti-raw")


def test_every_class_pickles_but_those_that_hold_a_device_or_a_file(objects):
    classes = {value for value in vars(adit).values() if isinstance(value, type) and value.__module__ == "adit._adit"}
    pickled = {type(one) for one in objects}
    rare = {adit.SimulationSummary, adit.Loop, adit.DoubtfulStretch, adit.ReferencePose, adit.Georeference}
    assert classes - pickled - rare == set(NONE)
    for one in classes - set(NONE):
        assert "__setstate__" in vars(one), one
    with pytest.raises(TypeError, match="cannot pickle"):
        pickle.dumps(adit.Odometry())


def test_views_of_an_unpickled_object_keep_it_alive():
    points = pickle.loads(pickle.dumps(adit.Sweep(np.ones((5, 3))))).points
    assert np.array_equal(points[:, :3], np.ones((5, 3))) and not points.flags.writeable


def test_damaged_states_raise(objects):
    dice = random.Random(3)
    for one in objects[::7]:
        version, state = one.__getstate__()
        if isinstance(state, str):
            continue
        with pytest.raises(ValueError, match="damaged"):
            type(one).__new__(type(one)).__setstate__((version, state[:-1]))
        with pytest.raises(ValueError, match="damaged"):
            type(one).__new__(type(one)).__setstate__((version, state + b"0"))
        for _ in range(20):
            damaged = bytearray(state)
            for _ in range(dice.randint(1, 8)):
                damaged[dice.randrange(len(damaged))] = dice.randrange(256)
            try:
                type(one).__new__(type(one)).__setstate__((version, bytes(damaged)))
            except ValueError:
                pass
    with pytest.raises(ValueError, match="none of adit's"):
        adit.Sweep.__new__(adit.Sweep).__setstate__(("1",))
    with pytest.raises(ValueError, match="pickled by adit 0.0.1, this is "):
        adit.Sweep.__new__(adit.Sweep).__setstate__(("0.0.1", b""))
