# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Maps and trajectories out of files."""

import numpy as np
import pytest

import adit


def test_keyframes_and_submaps(mapped):
    file, report, placed = mapped
    map_ = adit.Map(file)
    keyframes = map_.keyframes
    assert [k.id for k in keyframes] == list(range(report.keyframes))
    assert keyframes[0].stamp == placed[0].stamp and np.abs(keyframes[0].pose - np.eye(4)).max() < 1e-2
    points = sum(len(map_.submap(k.id)) for k in keyframes)
    assert points == report.points
    submap = map_.submap(keyframes[1].id)
    assert submap.points.dtype == np.float32 and submap.points.shape == submap.normals.shape
    assert submap.moving.dtype == bool and len(submap.sweep_of) == len(submap)
    norms = np.linalg.norm(submap.normals, axis=1)
    assert ((np.abs(norms - 1.0) < 1e-3) | (norms == 0.0)).all()
    assert len(submap.sweeps) >= 1 and submap.sweeps.stamps[0] == keyframes[1].stamp
    assert submap.sweep_of.max() < len(submap.sweeps)
    with pytest.raises(KeyError, match="the map has no keyframe 999"):
        map_.submap(999)


def test_graph_and_sessions(mapped):
    file, report, _ = mapped
    map_ = adit.Map(file)
    edges = map_.edges
    assert len(edges) == report.edges and {e.kind for e in edges} <= {"odometry", "loop"}
    assert (edges[0].from_, edges[0].to, edges[0].status) == (0, 1, "active")
    assert edges[0].information.shape == (6, 6) and edges[0].T_from_to.shape == (4, 4)
    session, = map_.sessions
    assert session.name == "drive.mcap" and "[preprocess]" in session.configuration
    assert session.provenance["device"] and session.provenance["recording"].endswith("drive.mcap")
    assert map_.check() == [] and map_.loops == [] and str(map_.path) == str(file)


def test_places(mapped):
    map_ = adit.Map(mapped[0])
    everything = map_.within([-1e4, -1e4, -1e4], [1e4, 1e4, 1e4])
    assert everything == [k.id for k in map_.keyframes]
    assert map_.within([9e3, 9e3, 9e3], [1e4, 1e4, 1e4]) == []
    with pytest.raises(ValueError, match="lower: not finite"):
        map_.within([np.nan, 0.0, 0.0], [1.0, 1.0, 1.0])


def test_fixes_and_georeference(mapped):
    file, report, _ = mapped
    map_ = adit.Map(file)
    fixes = map_.fixes
    assert len(fixes) == report.fixes > 10
    assert {fix.verdict for fix in fixes} <= {"waiting", "used", "thinned", "outlier", "frozen", "impossible", "apart"}
    assert fixes[0].covariance.shape == (3, 3) and -90.0 < fixes[0].latitude < 90.0
    georeference = map_.georeference
    assert report.georeferenced and georeference is not None
    place = georeference.place_of([1.0, 2.0, 3.0])
    np.testing.assert_allclose(georeference.position_of(*place), [1.0, 2.0, 3.0], atol=1e-6)


def test_a_map_is_finished_once(drive, tmp_path):
    recording = adit.open(drive)
    slam = adit.Slam.for_recording(recording, map=tmp_path / "m.adit")
    next(slam.process(recording))
    assert slam.finish_map().sweeps == 1
    with pytest.raises(ValueError, match="has ended this Slam"):
        slam.finish_map()
    with pytest.raises(ValueError, match="has ended this Slam"):
        slam.flush()


def test_trajectories_and_evaluation(drive, mapped, tmp_path):
    truth = adit.Trajectory.read(drive.with_suffix(".truth.tum"))
    estimate = adit.Map(mapped[0]).trajectory()
    evaluation = adit.evaluate(estimate, truth)
    assert evaluation.ate.rmse < 0.1 and evaluation.pairs == len(estimate) == len(evaluation.position_errors)
    assert evaluation.to_dict()["ate"] and "rmse" in repr(evaluation.ate)
    estimate.write(tmp_path / "a.kitti", format="kitti")
    estimate.write(tmp_path / "a.tum")
    again = adit.Trajectory.read(tmp_path / "a.tum")
    assert np.array_equal(again.stamps, estimate.stamps) and again.poses.shape == (len(again), 4, 4)
    assert adit.evaluate(tmp_path / "a.tum", truth, align="none").ate.rmse >= evaluation.ate.rmse
    with pytest.raises(ValueError, match="align: se3, sim3, origin or none"):
        adit.evaluate(estimate, truth, align="sim2")
    with pytest.raises(TypeError, match="estimate: a path or a Trajectory"):
        adit.evaluate(3, truth)
    with pytest.raises(ValueError, match="stamps"):
        adit.Trajectory([0.5], np.eye(4)[None])
    with pytest.raises(ValueError, match=r"poses: \(2, 4, 4\) is expected"):
        adit.Trajectory([0, 1], np.eye(4)[None])


def test_simulations_repeat(drive, tmp_path):
    summary = adit.simulate("city", tmp_path / "again.mcap", sensor="VLP-16", duration=4.0, seed=5, gnss="rtk")
    assert (tmp_path / "again.mcap").read_bytes() == drive.read_bytes()
    assert summary.sweeps == 40 and summary.imu_samples > 700 and summary.gnss_fixes > 10
