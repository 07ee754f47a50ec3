# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Odometry and Slam: the same bytes as the program, several threads, memory."""

import gc
import pathlib
import resource
import threading

import numpy as np
import pytest

import adit
from conftest import SHARED


def write(placed, file):
    adit.Trajectory([one.stamp for one in placed], [one.pose for one in placed]).write(file)
    return pathlib.Path(file).read_bytes()


def run(program, recording, out, *more):
    program("run", recording, "-o", out, "--quiet", *more)
    return pathlib.Path(out) / "trajectory.tum"


def test_process_gives_the_bytes_of_adit_run(drive, program, tmp_path):
    recording = adit.open(drive)
    assert recording.has_imu and recording.has_gnss
    slam = adit.Slam.for_recording(recording)
    placed = list(slam.process(recording))
    assert write(placed, tmp_path / "ours.tum") == run(program, drive, tmp_path / "out", "--odometry").read_bytes()
    assert [one.number for one in placed] == list(range(len(placed)))
    assert slam.mounting_source == "transforms" and slam.mounting.shape == (4, 4)
    assert slam.verdict.trust == "reliable" and slam.verdict.stretches == []
    assert slam.finish_map() is None
    assert placed[-1].result.inertial.velocity.shape == (3,)
    assert recording.damage == []


def test_adding_events_one_by_one_gives_the_same(drive, program, tmp_path):
    recording = adit.open(drive)
    slam = adit.Slam(recording.config, inertial=recording.has_imu, high_rate_smoothing=0.05)
    results = []
    for event in recording:
        if not isinstance(event, adit.ReferencePose):
            results += slam.add(event)
    results += slam.flush()
    placed = [one for one in results if isinstance(one, adit.SweepPlaced)]
    assert write(placed, tmp_path / "ours.tum") == run(program, drive, tmp_path / "out", "--odometry").read_bytes()
    motions = [one.motion for one in results if isinstance(one, adit.ReadingTaken) and one.motion]
    assert len(motions) > 300 and motions[0].covariance.shape == (9, 9)


def test_a_map_gives_the_trajectory_of_adit_run(drive, mapped, program, tmp_path):
    file, report, placed = mapped
    theirs = run(program, drive, tmp_path / "out")
    adit.Map(file).trajectory().write(tmp_path / "ours.tum")
    ours = adit.Trajectory.read(tmp_path / "ours.tum")
    np.testing.assert_allclose(ours.poses, adit.Trajectory.read(theirs).poses, rtol=0.0, atol=1e-9)
    assert write(placed, tmp_path / "online.tum") == (tmp_path / "out" / "online.tum").read_bytes()
    assert report.keyframes >= 2 and report.sweeps == len(placed) and report.components == 1
    program("check", file)


def test_odometry_without_an_imu_gives_the_bytes_of_adit_run(drive, program, tmp_path):
    odometry = adit.Odometry({"imu": {"use": False}})
    results = [odometry.register_frame(event) for event in adit.open(drive, {"imu.use": False})
               if isinstance(event, adit.Sweep)]
    ours = write(results, tmp_path / "ours.tum")
    assert ours == run(program, drive, tmp_path / "out", "--odometry", "--set", "imu.use=false").read_bytes()
    arrays = adit.Odometry({"imu": {"use": False}})
    for event, result in zip((e for e in adit.open(drive) if isinstance(e, adit.Sweep)), results):
        again = arrays.register_frame(event.points, event.times, stamp=event.stamp)
        assert np.array_equal(again.pose, result.pose) and np.array_equal(again.covariance, result.covariance)


def test_odometry_fuses_an_imu(drive):
    odometry = adit.Odometry()
    events = list(adit.open(drive))
    transform = next(e for e in events if isinstance(e, adit.StaticTransform) and e.child == "lidar")
    odometry.mount(transform.T_parent_child)
    samples = [e for e in events if isinstance(e, adit.ImuSample)]
    for sweep in (e for e in events if isinstance(e, adit.Sweep)):
        while samples and samples[0].stamp < sweep.stamp + 150_000_000:
            odometry.add_imu(samples.pop(0))
        result = odometry.register_frame(sweep)
    assert result.inertial.state == "fused" and result.state == "tracking"
    assert np.linalg.norm(result.inertial.gravity) == pytest.approx(9.8, abs=0.1)
    assert result.inertial.state_covariance.shape == (20, 20)


def test_kitti_gives_the_bytes_of_adit_run(program, tmp_path):
    folder = SHARED / "kitti_0001"
    if not folder.exists():
        pytest.skip("needs ../shared/data/kitti_0001")
    recording = adit.open(folder)
    placed = list(adit.Slam.for_recording(recording).process(recording))
    assert write(placed, tmp_path / "ours.tum") == run(program, folder, tmp_path / "out", "--odometry").read_bytes()


def cloud_of(seed, points=1500):
    random = np.random.default_rng(seed)
    walls = random.uniform((-6.0, -4.0, -1.5), (8.0, 5.0, 2.5), (points, 3))
    for axis, place in ((0, 8.0), (1, 5.0), (2, -1.5)):
        walls[axis::3, axis] = place
    return walls.astype(np.float32)


def test_two_threads_have_an_odometry_each():
    clouds = [cloud_of(seed, 9000) for seed in range(20)]
    alone = adit.Odometry()
    expected = [alone.register_frame(cloud).pose for cloud in clouds]
    found = {}

    def work(name):
        odometry = adit.Odometry()
        found[name] = [odometry.register_frame(cloud).pose for cloud in clouds]

    threads = [threading.Thread(target=work, args=(name,)) for name in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for name in range(2):
        assert np.array_equal(found[name], expected)


def test_other_threads_run_while_a_sweep_is_registered():
    odometry = adit.Odometry()
    clouds = [cloud_of(seed, 100_000) for seed in range(6)]
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    for cloud in clouds:
        odometry.register_frame(cloud)
    done.set()
    thread.join()
    assert counted[0] > 10_000


def test_memory_stays_flat_over_many_sweeps():
    odometry = adit.Odometry()
    clouds = [cloud_of(seed) for seed in range(10)]
    peaks = []
    for part in range(4):
        for i in range(500):
            odometry.register_frame(clouds[i % 10], np.linspace(0.0, 0.1, 1500))
        gc.collect()
        peaks.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
    assert peaks[3] - peaks[0] < 8 * 1024, peaks  # KiB


def test_a_result_outlives_its_odometry():
    odometry = adit.Odometry()
    result = odometry.register_frame(cloud_of(1))
    assert result.keyframe
    cloud = result.cloud
    del odometry, result
    gc.collect()
    assert cloud.shape[1] == 4 and np.isfinite(cloud).all() and not cloud.flags.writeable
