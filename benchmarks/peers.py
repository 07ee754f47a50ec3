#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Other systems' trajectories of simulated recordings, for `adit bench slam --trajectories`.

Usage: peers.py RECORDINGS -o OTHERS. Runs KISS-ICP and RKO-LIO with their default settings on the MCAP files of a
folder and writes OTHERS/SYSTEM/SEQUENCE.tum: T_any_lidar, each pose stamped with the time that it holds for. KISS-SLAM,
which closes loops, runs where it is asked for: kiss-slam with its defaults, kiss-slam-50m, -20m and -10m with local
maps that are split so often. It also leaves SEQUENCE.odometry.tum, its odometry without its closures, and
SEQUENCE.loops.csv, a closure a line: times of the two local maps and T_a_b, for `adit bench slam --loops`.

A pose of either holds for the last point of its sweep, to whose time points are de-skewed: KISS-ICP 1.3.0 leaves the
latest point where it is and moves the first by the whole motion, RKO-LIO 0.4.0 stamps its poses itself. Stamps half a
sweep and a whole one earlier or later fit the truth of three city drives worse, for both.

Exit codes: 0 done, 1 a system failed on a recording (which leaves no file, and the rest is run), 2 usage.
"""

import argparse
import functools
import importlib
import importlib.metadata
import os
import pathlib
import struct
import sys
import time

try:
    import numpy as np
    from mcap.reader import make_reader
    from pyquaternion import Quaternion
except ImportError as error:
    print(f"peers.py: {error}; pip install mcap zstandard numpy pyquaternion", file=sys.stderr)
    sys.exit(2)

# Types of a PointCloud2's fields by their number, and the fields with a point's time: their unit in ns, and whether it
# is counted from the epoch or from the stamp of the sweep. Drivers: Velodyne, Ouster, Hesai.
KINDS = {6: "<u4", 7: "<f4", 8: "<f8"}
CLOCKS = {"time": (1e9, False), "t": (1.0, False), "timestamp": (1e9, True)}


class Message:
    """Takes a little-endian CDR message apart; what it holds is aligned from behind its first four bytes."""

    def __init__(self, data):
        if data[:2] != b"\x00\x01":
            raise ValueError("a message is no little-endian CDR")
        self.data, self.at = data[4:], 0

    def take(self, code):
        size = struct.calcsize(code[-1])
        self.at += -self.at % size
        values = struct.unpack_from("<" + code, self.data, self.at)
        self.at += struct.calcsize("<" + code)
        return values[0] if len(values) == 1 else values

    def text(self):
        size = self.take("I")
        self.at += size
        return bytes(self.data[self.at - size : self.at]).rstrip(b"\0").decode()

    def header(self):
        """Stamp (ns) and frame."""
        seconds, nanoseconds = self.take("iI")
        return seconds * 1_000_000_000 + nanoseconds, self.text()


def read_cloud(data):
    """Frame, points (m) and their times (absolute ns) of a PointCloud2."""
    message = Message(data)
    stamp, frame = message.header()
    count = np.prod(message.take("II"), dtype=int)
    fields = {}
    for _ in range(message.take("I")):
        name, offset, kind, _ = message.text(), message.take("I"), message.take("B"), message.take("I")
        if kind in KINDS:
            fields[name] = (KINDS[kind], offset)
    clock = next((name for name in CLOCKS if name in fields), None)
    if clock is None or not {"x", "y", "z"} <= fields.keys():
        raise ValueError(f"a cloud of {', '.join(fields)}: expected x, y, z and one of {', '.join(CLOCKS)}")
    message.take("B")  # the byte order: adit's is little-endian
    step, _, _ = message.take("III")
    names = ["x", "y", "z", clock]
    layout = np.dtype({"names": names, "formats": [fields[name][0] for name in names],
                       "offsets": [fields[name][1] for name in names], "itemsize": step})
    cloud = np.frombuffer(message.data, layout, count, message.at)
    unit, is_absolute = CLOCKS[clock]
    times = np.rint(unit * cloud[clock].astype(float)).astype(np.int64)
    return frame, cloud, times if is_absolute else stamp + times


def read_livox(data):
    """The same of Livox's CustomMsg, without the returns that the sensor marks as noise (bits 4 and 5 of the tag)."""
    message = Message(data)
    _, frame = message.header()
    base = message.take("Q")
    message.take("IBBBB")
    count = message.take("I")
    layout = np.dtype({"names": ["time", "x", "y", "z", "tag"], "offsets": [0, 4, 8, 12, 17],
                       "formats": ["<u4", "<f4", "<f4", "<f4", "u1"], "itemsize": 20})
    # The last point has no byte of padding behind it.
    cloud = np.frombuffer(bytes(message.data[message.at :]) + b"\0", layout, count)
    cloud = cloud[(cloud["tag"] & 0x30) <= 0x10]
    return frame, cloud, base + cloud["time"].astype(np.int64)


def read_imu(data):
    """Frame, stamp (ns), acceleration (m/s^2) and angular velocity (rad/s)."""
    message = Message(data)
    stamp, frame = message.header()
    values = np.array(message.take("37d"))  # orientation 4 + 9, angular velocity 3 + 9, acceleration 3 + 9
    return frame, stamp, values[25:28], values[13:16]


def read_transforms(data):
    """T_parent_child by (parent, child)."""
    message = Message(data)
    transforms = {}
    for _ in range(message.take("I")):
        _, parent = message.header()
        child = message.text()
        x, y, z, *xyzw = message.take("7d")
        T = Quaternion(xyzw[3], *xyzw[:3]).transformation_matrix
        T[:3, 3] = x, y, z
        transforms[parent, child] = T
        transforms[child, parent] = np.linalg.inv(T)
    return transforms


CLOUDS = {"sensor_msgs/msg/PointCloud2": read_cloud, "livox_ros_driver2/msg/CustomMsg": read_livox}


def sweeps(recording):
    """(frame, points, times) of each sweep: points in metres, times in absolute ns."""
    with recording.open("rb") as stream:
        for schema, _, message in make_reader(stream).iter_messages():
            if schema.name in CLOUDS:
                frame, cloud, times = CLOUDS[schema.name](message.data)
                points = np.column_stack([cloud[axis] for axis in "xyz"]).astype(float)
                good = np.isfinite(points).all(axis=1)
                if good.any():
                    yield frame, points[good], times[good]


def inertial(recording):
    """Readings of the IMU and the transforms of a recording."""
    readings, transforms = [], {}
    with recording.open("rb") as stream:
        for schema, _, message in make_reader(stream).iter_messages():
            if schema.name == "sensor_msgs/msg/Imu":
                readings.append(read_imu(message.data))
            elif schema.name == "tf2_msgs/msg/TFMessage":
                transforms.update(read_transforms(message.data))
    return readings, transforms


def numbers(T):
    """x, y, z, qx, qy, qz, qw."""
    q = Quaternion(matrix=T, rtol=1e-4, atol=1e-4)
    return (*T[:3, 3], q.x, q.y, q.z, q.w)


class Outcome:
    """Poses are lines (ns, x, y, z, qx, qy, qz, qw), seconds those of each sweep, closures (ns, ns, x, ..., qw) between
    so many local maps."""

    def __init__(self, poses, seconds, odometry=None, closures=None, maps=0):
        self.poses, self.seconds, self.odometry, self.closures, self.maps = poses, seconds, odometry, closures, maps


def run_kiss_icp(recording, threads):
    from kiss_icp.config import load_config
    from kiss_icp.kiss_icp import KissICP

    config = load_config(None)
    config.registration.max_num_threads = threads
    odometry = KissICP(config)
    poses, seconds = [], []
    for _, points, times in sweeps(recording):
        begin = time.perf_counter()
        odometry.register_frame(points, 1e-9 * (times - times.min()))  # which it scales to 0 to 1
        seconds.append(time.perf_counter() - begin)
        poses.append((times.max(), *numbers(odometry.last_pose)))
    return Outcome(poses, seconds)


def run_kiss_slam(recording, threads, split=None):
    """As its own pipeline does. `split`: metres from where on a local map is complete; none: its default."""
    from kiss_slam.config import load_config
    from kiss_slam.slam import KissSLAM

    config = load_config(None)
    config.odometry.registration.max_num_threads = threads
    config.local_mapper.splitting_distance = split or config.local_mapper.splitting_distance
    slam = KissSLAM(config)
    constraints = []
    add = slam.optimizer.add_factor

    def noted(source, target, pose, information):
        constraints.append((source, target, np.array(pose)))
        add(source, target, pose, information)

    slam.optimizer.add_factor = noted
    stamps, begins, seconds = [], [], []  # begins: of local maps, at the sweep that the one before ends with
    for _, points, times in sweeps(recording):
        begin = time.perf_counter()
        stamps.append(times.max())
        begins = begins or [stamps[0]]
        slam.process_scan(points, 1e-9 * (times - times.min()))
        seconds.append(time.perf_counter() - begin)
        if len(slam.get_keyposes()) > len(begins):
            begins.append(stamps[-1])
    slam.generate_new_node()
    slam.local_map_graph.erase_last_local_map()
    poses, _ = slam.fine_grained_optimization()
    # A factor holds T_target_source. Those of closures lead from an earlier local map to a later one.
    closures = [(begins[a], begins[b], *numbers(np.linalg.inv(T_b_a))) for a, b, T_b_a in constraints
                if (a, b) in slam.closures]
    odometry, T_any_map = [], np.eye(4)
    for number, local in enumerate(slam.local_map_graph.local_maps()):
        # All but the first begin with the pose that the one before ends with.
        odometry += [T_any_map @ T for T in local.local_trajectory[1 if number else 0 :]]
        T_any_map = T_any_map @ local.local_trajectory[-1]
    stamped = [[(t, *numbers(T)) for t, T in zip(stamps, some, strict=True)] for some in (poses, odometry)]
    return Outcome(stamped[0], seconds, stamped[1], closures, len(slam.get_keyposes()))


def run_rko_lio(recording, threads):
    """The base is the lidar, as in RKO-LIO's own program unless it is told another: poses are the lidar's."""
    from rko_lio.config import LIOConfig
    from rko_lio.lio import LIO
    from rko_lio.rko_lio_pybind import InputError

    readings, transforms = inertial(recording)
    odometry = LIO(LIOConfig(max_num_threads=threads))
    seconds, fed = [], 0
    for frame, points, times in sweeps(recording):
        begin, end = time.perf_counter(), times.max()
        # As its own program does: a sweep is taken once a reading behind its end is there, and those before it are in.
        if not readings or readings[-1][1] <= end:
            break
        while readings[fed][1] < end:
            imu_frame, stamp, acceleration, rate = readings[fed]
            if (frame, imu_frame) not in transforms:
                raise ValueError(f"no transform between {frame} and {imu_frame}")
            odometry.add_imu_measurement(acceleration, rate, stamp, transforms[frame, imu_frame])
            fed += 1
        try:
            odometry.register_scan(points, times)
        except InputError as error:  # its own program drops such sweeps
            print(f"\n{recording.stem}: a sweep dropped: {error}", file=sys.stderr)
        seconds.append(time.perf_counter() - begin)
    stamps, poses = odometry.poses_with_timestamps()
    return Outcome([(stamp, *pose) for stamp, pose in zip(stamps, poses, strict=True)], seconds)


# By name: the runner, the packages whose versions are told, and the modules that it needs.
SYSTEMS = {
    "kiss-icp": (run_kiss_icp, ("kiss-icp",), ("kiss_icp.kiss_icp",)),
    "rko-lio": (run_rko_lio, ("rko_lio",), ("rko_lio.lio",)),
    "kiss-slam": (run_kiss_slam, ("kiss-slam", "kiss-icp", "map_closures"), ("kiss_slam.slam",)),
}
for metres in (50, 20, 10):
    SYSTEMS[f"kiss-slam-{metres}m"] = (functools.partial(run_kiss_slam, split=metres), *SYSTEMS["kiss-slam"][1:])
DEFAULT = ("kiss-icp", "rko-lio")


def time_text(t):
    return f"{t // 10**9}.{t % 10**9:09d}"


def write_tum(path, poses):
    lines = [time_text(t) + " " + " ".join(f"{value:.9g}" for value in pose) for t, *pose in poses]
    path.write_text("\n".join(lines) + "\n")


def write_closures(path, closures):
    lines = [",".join([time_text(a), time_text(b)] + [f"{value:.9g}" for value in pose]) for a, b, *pose in closures]
    path.write_text("\n".join(["time_a_s,time_b_s,x,y,z,qx,qy,qz,qw"] + lines) + "\n")


def run(system, recording, folder, threads):
    """What to say of it; raises where it failed, and then leaves no file."""
    files = [folder / f"{recording.stem}{ending}" for ending in (".tum", ".odometry.tum", ".loops.csv")]
    for file in files:
        file.unlink(missing_ok=True)
    outcome = SYSTEMS[system][0](recording, threads)
    if not outcome.poses:
        raise ValueError("no sweep was placed")
    if not np.isfinite(np.array(outcome.poses, dtype=float)).all():
        raise ValueError("a pose is not finite")
    write_tum(files[0], outcome.poses)
    said = f"{len(outcome.poses)} poses, {1e3 * np.mean(outcome.seconds):.1f} ms a sweep"
    if outcome.closures is not None:
        write_tum(files[1], outcome.odometry)
        write_closures(files[2], outcome.closures)
        said += f", {len(outcome.closures)} closures of {outcome.maps} local maps"
    return said


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", type=pathlib.Path, help="folder of MCAP files")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="folder for SYSTEM/SEQUENCE.tum")
    parser.add_argument("--systems", nargs="+", choices=SYSTEMS, default=DEFAULT)
    parser.add_argument("--only", nargs="+", default=[""], help="names of sequences, or how they begin")
    parser.add_argument("--threads", type=int, default=1, help="of each system; with one, runs agree to the last digit")
    options = parser.parse_args()
    recordings = sorted(options.recordings.glob("*.mcap"))
    for wanted in options.only:
        if not any(path.stem.startswith(wanted) for path in recordings):
            parser.error(f"{options.recordings}: there is no {wanted}*.mcap in it")
    recordings = [path for path in recordings if path.stem.startswith(tuple(options.only))]
    for system in options.systems:
        _, packages, modules = SYSTEMS[system]
        try:
            for module in modules:
                importlib.import_module(module)
        except ImportError as error:
            parser.error(f"{system}: {error}; pip install {' '.join(packages)}")
        versions = "".join(f"{name} {importlib.metadata.version(name)}\n" for name in (*packages, "numpy"))
        (options.output / system).mkdir(parents=True, exist_ok=True)
        (options.output / system / "version.txt").write_text(versions)
    # RKO-LIO writes to the standard output: that goes with the progress, the lines below stay by themselves.
    lines = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    failed = False
    for number, recording in enumerate(recordings, 1):
        for system in options.systems:
            print(f"{number} of {len(recordings)}: {recording.stem}, {system}", file=sys.stderr, flush=True)
            try:
                said = run(system, recording, options.output / system, options.threads)
            except Exception as error:  # whatever a system or a file fails with, the others are run
                failed, said = True, f"failed: {error or type(error).__name__}"
            print(f"{recording.stem:<28} {system:<10} {said}", file=lines, flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
