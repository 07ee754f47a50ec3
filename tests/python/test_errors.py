# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Wrong arguments give exceptions that name the argument and say what is expected."""

import pickle

import numpy as np
import pytest

import adit

CLOUD = np.random.default_rng(1).uniform(-10.0, 10.0, (2000, 4)).astype(np.float32)


def test_arrays_that_were_unpickled_are_taken():
    again = pickle.loads(pickle.dumps(CLOUD))
    assert adit.Sweep(again, stamp=1).points.shape == CLOUD.shape
    assert adit.Sweep(again[:, :3].astype(np.float64), stamp=1).points.shape == CLOUD.shape


@pytest.mark.parametrize("points, error, message", [
    ("cloud", TypeError, "points: an array or list of numbers is expected, not str"),
    (np.ones((5, 3), bool), TypeError, "points: numbers are expected, not bool"),
    (np.ones((5, 2)), ValueError, r"points: has the shape \(5, 2\), not \(n, 3\) or \(n, 4\)"),
    (np.ones(12), ValueError, r"points: has the shape \(12,\)"),
    (np.ones((2, 5, 3)), ValueError, r"\(2, 5, 3\)"),
    (np.ones((0, 3)), ValueError, "points: has no point"),
    (np.full((5, 3), np.nan), ValueError, "points: none of 5 is a return"),
    (np.zeros((5, 3)), ValueError, "none of 5 is a return"),
])
def test_clouds_that_are_none(points, error, message):
    with pytest.raises(error, match=message):
        adit.Odometry().register_frame(points)


def test_what_is_no_return_is_passed_over():
    points = CLOUD.copy()
    points[::2] = np.nan
    result = adit.Odometry().register_frame(points)
    assert (result.raw_points, result.valid_points) == (2000, 1000)


@pytest.mark.parametrize("points", [CLOUD[:, :3], CLOUD.astype(np.float64), np.asfortranarray(CLOUD), CLOUD[:, :3].copy()])
def test_layouts_make_no_difference(points):
    expected = adit.Odometry().register_frame(CLOUD[:, :3].copy()).cloud[:, :3]
    assert np.array_equal(adit.Odometry().register_frame(points).cloud[:, :3], expected)


def test_timestamps_and_stamps():
    odometry = adit.Odometry()
    with pytest.raises(ValueError, match="timestamps: 3 for 2000 points"):
        odometry.register_frame(CLOUD, np.zeros(3))
    with pytest.raises(ValueError, match="timestamps: not finite"):
        odometry.register_frame(CLOUD, np.full(2000, np.nan))
    with pytest.raises(ValueError, match=r"timestamps: has the shape \(2000, 1\), not \(n,\)"):
        odometry.register_frame(CLOUD, np.zeros((2000, 1)))
    odometry.register_frame(CLOUD, stamp=1000)
    with pytest.raises(ValueError, match="stamp: 1000 ns is not after 1000 ns"):
        odometry.register_frame(CLOUD, stamp=1000)
    assert odometry.register_frame(CLOUD).stamp == 1000 + 100_000_000


def test_measurements():
    with pytest.raises(ValueError, match=r"angular_velocity: has the shape \(2,\), not \(3,\)"):
        adit.ImuSample(0, [0.0, 0.0], [0.0, 0.0, 9.8])
    with pytest.raises(ValueError, match="latitude: not finite"):
        adit.GnssFix(0, float("nan"), 8.0, 500.0)
    with pytest.raises(ValueError, match=r"covariance: has the shape \(3,\), not \(3, 3\)"):
        adit.GnssFix(0, 47.0, 8.0, 500.0, np.ones(3))
    with pytest.raises(ValueError, match="kind: none, single"):
        adit.GnssFix(0, 47.0, 8.0, 500.0, kind="magic")
    with pytest.raises(ValueError, match="T_parent_child: is no rigid transformation"):
        adit.StaticTransform("a", "b", 2.0 * np.eye(4))
    with pytest.raises(ValueError, match="guess: not finite"):
        adit.align(CLOUD, CLOUD, np.full((4, 4), np.nan))
    with pytest.raises(ValueError, match="rings: 1 for 2000 points"):
        adit.Sweep(CLOUD, rings=[1])
    with pytest.raises(ValueError, match="doppler: 2 for 2000 points"):
        adit.Sweep(CLOUD, doppler=np.zeros(2))
    speeds = np.linspace(-3.0, 3.0, 2000, dtype=np.float32)
    assert np.array_equal(adit.Sweep(CLOUD, doppler=speeds).doppler, speeds) and adit.Sweep(CLOUD).doppler is None
    fix = adit.GnssFix(7, 47.0, 8.0, 500.0, np.eye(3), kind="single", frame="gnss")
    assert (fix.stamp, fix.kind, fix.frame, fix.topic, fix.received) == (7, "single", "gnss", "", None)
    velocity = adit.BodyVelocity(9, [1.0, 0.0, float("nan")], 0.01 * np.eye(3), frame="wheels")
    assert (velocity.stamp, velocity.frame, velocity.topic) == (9, "wheels", "") and velocity.linear[0] == 1.0
    assert np.array_equal(velocity.covariance, 0.01 * np.eye(3)) and np.isnan(velocity.linear[2])
    assert adit.BodyVelocity(9, [1.0, 0.0, 0.0]).covariance is None
    with pytest.raises(ValueError, match=r"covariance: has the shape \(3,\), not \(3, 3\)"):
        adit.BodyVelocity(0, [1.0, 0.0, 0.0], np.ones(3))
    heading = adit.Heading(9, 0.5, 0.02, frame="antenna")
    assert (heading.stamp, heading.yaw, heading.sigma, heading.frame) == (9, 0.5, 0.02, "antenna")
    assert adit.Heading(9, 0.5).sigma is None
    with pytest.raises(ValueError, match="yaw: not finite"):
        adit.Heading(0, float("inf"))
    sweep = adit.Sweep(CLOUD, np.linspace(0.0, 0.1, 2000), stamp=5, rings=[1] * 2000)
    assert len(sweep) == 2000 and np.array_equal(sweep.points, CLOUD) and sweep.rings[5] == 1


def test_settings(tmp_path):
    with pytest.raises(adit.UsageError, match="^preprocess.r_imput=0.5: there is no setting 'preprocess.r_imput'.*r_input"):
        adit.Config(preprocess={"r_imput": 0.5})
    with pytest.raises(adit.UsageError, match="there is no section 'mappings'"):
        adit.Odometry({"mappings.enabled": True})
    for settings in ({"prprocess": {}}, {"prprocess": None}, {"prprocess": {"r_input": 0.5}}, {"prprocess.r_input": None}):
        with pytest.raises(adit.UsageError, match="there is no section 'prprocess'. The nearest valid name is 'preprocess'"):
            adit.Config(settings)
    with pytest.raises(adit.UsageError, match="^prprocess: there is no section 'prprocess'.*'preprocess'"):
        adit.Config(prprocess={})
    for settings in ({"r_imput": None}, {"r_imput": {}}):
        with pytest.raises(adit.UsageError, match="no setting 'preprocess.r_imput'.*'preprocess.r_input'"):
            adit.Config(preprocess=settings)
    assert adit.Config(preprocess={}, mapping=None) == adit.Config()
    with pytest.raises(ValueError, match="preprocess.c_max is 0.2; must be greater than"):
        adit.Config({"preprocess": {"c_max": 0.2}})
    with pytest.raises(adit.UsageError, match="imu.use is of type|imu.use"):
        adit.Config(imu={"use": "perhaps"})
    with pytest.raises(TypeError, match="config: None, a Config, a dictionary or the path"):
        adit.Odometry(5)
    with pytest.raises(TypeError, match="imu.lag: a number"):
        adit.Config(imu={"lag": object()})
    file = tmp_path / "adit.toml"
    file.write_text("[preprocess]\nr_imput = 0.5\n")
    with pytest.raises(adit.InputError, match="adit.toml, line 2, column 1"):
        adit.Config(file)
    file.write_text("[preprocess]\nr_input = 0.4\n[imu]\nT_imu_lidar = [0, 0, 0, 0, 0, 0, 1]\n")
    config = adit.Config(file, registration={"d_max": 1.5}, recording={"imu_topic": "/imu", "sweep_topic": None})
    assert config["preprocess.r_input"] == 0.4 and config["registration"]["d_max"] == 1.5
    assert config["imu.T_imu_lidar"] == [0, 0, 0, 0, 0, 0, 1] and config["recording.sweep_topic"] is None
    assert config != adit.Config() and config == adit.Config(config) == adit.Config(config.to_dict())
    assert "preprocess.r_input=0.4" in repr(config) and "registration.d_max=1.5" in repr(config)
    with pytest.raises(KeyError):
        config["preprocess.nothing"]
    assert "kitti" in " ".join(adit.presets())


def test_files_and_devices(tmp_path, drive):
    with pytest.raises(adit.InputError, match="nowhere.mcap"):
        adit.open(tmp_path / "nowhere.mcap")
    with pytest.raises(adit.UsageError, match="there is no topic '/point'. .*'/points'"):
        adit.open(drive).events(["/point"])
    with pytest.raises(adit.UsageError, match="no IMU on '/imus'"):
        iter(adit.open(drive, {"recording.imu_topic": "/imus"}))
    with pytest.raises(adit.InputError):
        adit.Map(drive)
    with pytest.raises(adit.OutputError, match="exists. A map is written into a new file"):
        adit.Slam(map=drive)
    with pytest.raises(adit.UsageError, match="no such device"):
        adit.Odometry(device="no such device")
    with pytest.raises(TypeError, match="device: None, a name or a Device"):
        adit.Odometry(device=3)
    with pytest.raises(adit.DeviceError, match="budget"):
        adit.Odometry(device=adit.Device(max_vram=1000)).register_frame(CLOUD)
    with pytest.raises(adit.UsageError, match="scene"):
        adit.simulate("nowhere", tmp_path / "x.mcap")
    with pytest.raises(adit.InputError):
        adit.evaluate(drive.with_suffix(".nothing"), drive)
    assert issubclass(adit.UsageError, ValueError) and issubclass(adit.InputError, adit.Error)


def test_damage_is_passed_over_or_raised(drive, tmp_path):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(drive.read_bytes()[:-200_000])
    recording = adit.open(cut)
    sweeps = sum(isinstance(event, adit.Sweep) for event in recording)
    assert sweeps > 5 and "cut.mcap" in recording.damage[0]
    with pytest.raises(adit.InputError, match="cut.mcap"):
        list(adit.open(cut, strict=True))
