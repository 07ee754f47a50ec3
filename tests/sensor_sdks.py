#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Compares how `adit` reads the packets of lidars with what other programs make of them.

Usage: sensor_sdks.py ADIT [--seed S] [--only WORD] [--folder FOLDER]. It needs ouster-sdk, velodyne-decoder, hydra4,
mcap, rosbags and numpy from PyPI. For each case it writes a packet capture with random ranges, has `adit convert
--repair` turn it into point clouds, and compares number, positions, intensities and times of the points. Ouster's
packets are written and read by ouster-sdk; Velodyne's are written here and read by velodyne-decoder, Hesai's by hydra4.
Livox's, and rows of "its manual" or "maker's formula", are written and worked out here, after the makers' manuals. Exits 1 where a case
differs.
"""

import argparse
import json
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import time

try:
    import numpy as np
    import velodyne_decoder as vd
    from mcap.reader import make_reader
    from ouster.sdk import core
    from ouster.sdk.pcap import PcapPacketSource
    from rosbags.typesys import Stores, get_typestore

    from sensor_captures import BEGIN, DUAL, SINGLE, Case, Points, write_capture
    from sensor_hesai import hesai_cases
except ImportError as error:
    packages = "ouster-sdk velodyne-decoder hydra4 mcap rosbags numpy"
    print(f"sensor_sdks.py: {error}; pip install {packages}", file=sys.stderr)
    sys.exit(2)

NUMPY_OF = {1: "i1", 2: "u1", 3: "<i2", 4: "<u2", 5: "<i4", 6: "<u4", 7: "<f4", 8: "<f8"}


def cloud_of(message):
    assert not message.is_bigendian and message.row_step == message.point_step * message.width
    kind = np.dtype({"names": [field.name for field in message.fields],
                     "formats": [NUMPY_OF[field.datatype] for field in message.fields],
                     "offsets": [field.offset for field in message.fields], "itemsize": message.point_step})
    return message.data.view(kind)


def convert(adit, case):
    out = case.capture.with_suffix(".mcap")
    out.unlink(missing_ok=True)  # some captures are compared twice
    command = [adit, "convert", case.capture, out, "--repair", "--ros", "2"]
    command += ["--metadata", case.metadata] if case.metadata else []
    run = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(f"{case.name}: adit convert ends with {run.returncode}: {run.stdout}{run.stderr}")
    return out


def read_ours(adit, case):
    """All returns; Ouster's in the frame of the sensor, as /tf_static tells it, not in that of the lidar."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    points, transforms = Points(), {}
    with open(convert(adit, case), "rb") as file:
        for schema, _, data in make_reader(file).iter_messages(log_time_order=False):
            message = store.deserialize_cdr(data.data, schema.name)
            if schema.name == "tf2_msgs/msg/TFMessage":
                transforms.update({one.child_frame_id: one.transform for one in message.transforms})
            if schema.name != "sensor_msgs/msg/PointCloud2":
                continue
            cloud = cloud_of(message)
            stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
            xyz = np.stack([cloud[axis].astype(np.float64) for axis in "xyz"], axis=1)
            kept = np.isfinite(xyz).all(axis=1) & xyz.any(axis=1)
            after = next(cloud[name] for name in ("t", "time", "timestamp") if name in cloud.dtype.names)
            assert after.dtype.kind == "f", "times in seconds after the stamp"
            points.add(xyz[kept], cloud["intensity"][kept], (stamp - BEGIN) + 1e9 * after.astype(np.float64)[kept])
    if "os_lidar" in transforms:
        r, t = transforms["os_lidar"].rotation, transforms["os_lidar"].translation
        assert max(abs(r.x), abs(r.y), abs(r.w)) < 1e-12, "half a turn"
        points.positions = [xyz * [-1, -1, 1] + [t.x, t.y, t.z] for xyz in points.positions]
    return points


def ouster_case(profile, folder, random):
    """ouster-sdk writes the packets; some columns are not valid, one packet is lost."""
    content = json.loads(core.SensorInfo.from_default(core.LidarMode._1024x10).to_json_string())
    content["lidar_data_format"]["udp_profile_lidar"] = profile
    content["lidar_data_format"]["header_type"] = "FUSA" if profile.startswith("FUSA") else "STANDARD"
    content["config_params"].update(udp_profile_lidar=profile, udp_port_lidar=7502, udp_port_imu=7503)
    metadata = folder / f"ouster_{profile}.json"
    metadata.write_text(json.dumps(content))
    info = core.SensorInfo(metadata.read_text())
    writer = core.PacketFormat.from_info(info)
    unit, intensity = (8, "REFLECTIVITY") if "RNG15" in profile else (1, "SIGNAL")
    names = [name for name in ("RANGE", "RANGE2") if name in core.LidarFrame(info).fields]
    packets = []
    for number in range(4):
        frame = core.LidarFrame(info)
        frame.frame_id = 700 + number
        frame.measurement_id[:] = np.arange(frame.w)
        frame.timestamp[:] = BEGIN + 100_000_000 * number + 97_656 * frame.measurement_id.astype(np.int64)
        frame.timestamp[:] += random.integers(0, 50, frame.w).astype(np.uint64)
        frame.status[:] = np.where(random.random(frame.w) > 0.03, 0xffffffff if profile == "LEGACY" else 1, 0)
        for name in frame.fields:
            field = frame.field(name)
            if name in names:
                field[:] = random.integers(300, 120_000, field.shape) // unit * unit
                field[random.random(field.shape) < 0.2] = 0
            elif field.dtype.kind == "u" and field.shape == (frame.h, frame.w):
                field[:] = random.integers(1, 256, field.shape)
        if len(names) == 2:  # some second returns are the first once more
            same = random.random((frame.h, frame.w)) < 0.3
            frame.field("RANGE2")[same] = frame.field("RANGE")[same]
        for i, packet in enumerate(core.frame_to_packets(frame, writer, info.init_id, 122_000_000)):
            if (number, i) != (2, 20):
                packets.append((int(frame.timestamp[-1]) - BEGIN, bytes(packet.buf)))
    capture = folder / f"ouster_{profile}.pcap"
    write_capture(capture, packets, 7502)
    return Case(f"Ouster {profile}", "ouster-sdk", capture, lambda: ouster_points(info, capture, metadata, intensity),
                metadata, tolerance=20e-6)


def ouster_points(info, capture, metadata, intensity):
    lut = core.XYZLut(info, use_extrinsics=False)
    batcher = core.FrameBatcher(info)
    points = Points()

    def take(frame):
        ranges = [frame.field(name) for name in ("RANGE", "RANGE2") if name in frame.fields]
        kept = [ranges[0] > 0] + [(second > 0) & (second != ranges[0]) for second in ranges[1:]]
        valid = (frame.status & 1) != 0
        # column by column, beam by beam, return by return
        kept = np.stack(kept, axis=-1).transpose(1, 0, 2) & valid[:, None, None]
        xyz = np.stack([lut(one) for one in ranges], axis=2).transpose(1, 0, 2, 3)
        strength = [frame.field(intensity + ending) for ending in ("", "2")[:len(ranges)]]
        moments = (frame.timestamp.astype(np.int64) - BEGIN)[:, None, None]
        points.add(xyz[kept], np.stack(strength, axis=-1).transpose(1, 0, 2)[kept],
                   np.broadcast_to(moments, kept.shape)[kept])

    frame = core.LidarFrame(info)
    for _, packet in PcapPacketSource(str(capture), meta=[str(metadata)]):
        if batcher.batch(packet, frame):
            take(frame)
            frame = core.LidarFrame(info)
            batcher.batch(packet, frame)
    take(frame)
    return points


def calibration_of(model):
    """Elevations and azimuths (degrees, clockwise) and heights (m) of a model's lasers, as velodyne-decoder has them."""
    text = vd.Calibration.default_calibs[model].to_string()
    lasers = {key: [float(value) for value in re.findall(f"{key}: (\\S+)", text)]
              for key in ("vert_correction", "rot_correction", "vert_offset_correction")}
    elevations, azimuths = (np.degrees(lasers[key]).round(3) for key in ("vert_correction", "rot_correction"))
    return elevations, -azimuths, np.array(lasers["vert_offset_correction"])


class Velodyne:
    """A model after its manual: its lasers all fire once a cycle, `within` it (s), as it turns by `degrees`."""

    def __init__(self, model):
        self.model, self.unit, self.azimuths, self.heights = model, 2e-3, 0.0, 0.0
        if model == "VLP-16":
            self.code, self.lasers, self.cycle, self.degrees = 0x22, 16, 55.296e-6, 0.24
            self.within = 2.304e-6 * np.arange(16)
            self.elevations = np.array([i if i % 2 else i - 15 for i in range(16)])
            self.heights = -1e-4 * np.round(419.1 * np.tan(np.radians(self.elevations)))
        elif model == "HDL-32E":
            self.code, self.lasers, self.cycle, self.degrees = 0x21, 32, 46.08e-6, 0.40
            self.within = 1.152e-6 * np.arange(32)
            self.elevations = np.array([(-28 if i % 2 else -92) / 3 + 4 / 3 * (i // 2) for i in range(32)]).round(2)
        elif model == "VLP-32C":  # two lasers at a time
            self.code, self.lasers, self.cycle, self.degrees, self.unit = 0x28, 32, 55.296e-6, 0.24, 4e-3
            self.within = 2.304e-6 * (np.arange(32) // 2)
            self.elevations, self.azimuths, self.heights = calibration_of(vd.Model.VLP32C)
        else:  # VLS-128: eight at a time, with a break after half of them
            self.code, self.lasers, self.cycle, self.degrees, self.unit = 0xa1, 128, 53.3e-6, 0.20, 4e-3
            self.within = 2.665e-6 * (np.arange(128) // 8 + np.arange(128) // 64)
            self.elevations, self.azimuths, self.heights = calibration_of(vd.Model.VLS128)
        self.before = 8.7e-6 if model == "VLS-128" else 0.0  # s from the first firing to the packet's time
        self.firings = max(1, 32 // self.lasers)  # in a block
        self.blocks = max(1, self.lasers // 32)  # of a firing

    def points(self, azimuth, ranges):
        """Positions of the ranges at an azimuth, and seconds after their first firing."""
        within = np.concatenate([self.within + self.cycle * i for i in range(self.firings)])
        elevation, heights = (np.resize(one, within.shape) for one in (np.radians(self.elevations), self.heights))
        angle = np.radians(azimuth + self.azimuths + self.degrees * within / self.cycle)
        flat = self.unit * ranges * np.cos(elevation)
        return np.stack([flat * np.cos(angle), -flat * np.sin(angle),
                         self.unit * ranges * np.sin(elevation) + heights], axis=1), within


def velodyne_packet(sensor, blocks, dual, micros):
    """`blocks` of an azimuth, ranges and reflectivities of all lasers, one for each return."""
    packet = b""
    for first in range(0, len(blocks), 2 if dual else 1):
        for bank in range(sensor.blocks):
            for azimuth, ranges, strengths in blocks[first:first + (2 if dual else 1)]:
                part = slice(32 * bank, 32 * bank + 32)
                packet += struct.pack("<HH", (0xeeff, 0xddff, 0xccff, 0xbbff)[bank], azimuth)
                packet += b"".join(struct.pack("<HB", *one)
                                   for one in zip(ranges[part].tolist(), strengths[part].tolist()))
    packet += bytes(1200 - len(packet))
    return packet + struct.pack("<IBB", micros, DUAL if dual else SINGLE, sensor.code)


def velodyne_case(model, dual, manual, folder, random):
    """Data packets after the manuals of Velodyne's models: twelve blocks of an azimuth and 32 ranges.

    They turn by 0.01 degrees from a group of lasers to the next, as velodyne-decoder rounds azimuths to that: 9 mm at
    100 m. What it makes of them is up to 0.7 urad off, 70 um at 100 m, and its heights of VLP-16's lasers differ from
    the manual's, which are rounded, by 30 um. Its VLS-128 breaks for two groups after half of a firing and not for one,
    which is 0.01 degrees, and takes 7 us and not 8.7 us off a packet's time. Of that it does not know how fast it turns
    in its first packet.
    """
    sensor = Velodyne(model)
    count = max(32, sensor.lasers)
    firings = 12 // sensor.blocks // (2 if dual else 1)  # of a packet
    period, step = sensor.cycle * sensor.firings, sensor.degrees * sensor.firings
    turns, most = (1.2, 12_000) if model == "VLS-128" else (3.2, 50_000)
    packets, points = [], Points()
    for number in range(int(turns * 360 / step / firings)):
        micros = 5_000_000 + round(1e6 * number * firings * period)
        blocks = []
        for block in range(firings * (2 if dual else 1)):
            turn = block // 2 if dual else block
            azimuth = round(100 * (30.0 + step * (number * firings + turn))) % 36000
            fresh = random.integers(250, most, count)
            fresh[random.random(count) < 0.15] = 0
            values = random.integers(0, 256, count)
            kept = fresh > 0
            if dual and block % 2 == 1:  # the same return once more where there is no other
                same = (random.random(count) < 0.4) | (ranges == 0) | (ranges == fresh)
                fresh, values = np.where(same, ranges, fresh), np.where(same, strengths, values)
                kept &= ~same
            ranges, strengths = fresh, values
            blocks.append((azimuth, ranges, strengths, kept, turn))
        order = [(first, bank, block) for first in range(0, len(blocks), 2 if dual else 1)
                 for bank in range(0, count, 32) for block in blocks[first:first + (2 if dual else 1)]]
        for _, bank, (azimuth, row, values, kept, turn) in order:
            part = np.zeros(count, dtype=bool)
            part[bank:bank + 32] = True
            xyz, within = sensor.points(1e-2 * azimuth, row)
            chosen = part & kept
            points.add(xyz[chosen], values[chosen],
                       1000 * micros + 1e9 * (period * turn + within[chosen] - sensor.before))
        packets.append((1000 * micros, velodyne_packet(sensor, [one[:3] for one in blocks], dual, micros)))
    name = f"{model}{' dual' if dual else ''}"
    capture = folder / f"velodyne_{name.replace(' ', '_')}.pcap"
    write_capture(capture, packets, 2368)
    if manual:
        # 32-bit numbers between 128 and 256 m are 15 um apart: three coordinates are within 13.2 um
        return Case(f"Velodyne {name}", "its manual", capture, lambda: points, tolerance=14e-6)
    notes = {"HDL-32E": "heights taken out", "VLS-128": "other times of firing"}
    loose = model == "VLS-128"
    return Case(f"Velodyne {name}", "velodyne-decoder", capture, lambda: velodyne_points(model, capture),
                tolerance=20e-3 if loose else 150e-6, time_tolerance=6e-6 if loose else 500e-9,
                note=notes.get(model, ""), begin=5e9 + 2e9 * period * firings - 10_200 if loose else 0.0)


def banks_of(cloud):
    """The block of 32 lasers that a point of VLS-128 is from, by its time in the firing: 8 lasers each 2.667 us."""
    begin = np.full(cloud["column"].max() + 1, np.inf)
    np.minimum.at(begin, cloud["column"], cloud["time"])
    group = np.round((cloud["time"] - begin[cloud["column"]]) / (8e-6 / 3)).astype(int)
    return (group - 2 * (group >= 8)) // 4


def velodyne_points(model, capture):
    config = vd.Config(min_range=0, max_range=1000, timestamp_first_packet=True)
    if model == "HDL-32E":  # adit takes its lasers to be at one height
        text = vd.Calibration.default_calibs[vd.Model.HDL32E].to_string()
        lines = [line for line in text.splitlines() if "vert_offset_correction" not in line]
        config.calibration = vd.Calibration.from_string("\n".join(lines))
    points = Points()
    for stamp, cloud in vd.read_pcap(str(capture), config, as_pcl_structs=True):
        # Block by block: of two returns, the last one comes in a block before the strongest one.
        pair = cloud["column"] // (2 if model == "VLP-16" else 1)
        bank = banks_of(cloud) if model == "VLS-128" else np.zeros(len(cloud))
        cloud = cloud[np.lexsort((cloud["return_type"] == vd.ReturnMode.STRONGEST.value, bank, pair))]
        points.add(np.stack([cloud[axis] for axis in "xyz"], axis=1), cloud["intensity"],
                   1e9 * (stamp.device - BEGIN // 10**9 + cloud["time"].astype(np.float64)))
    return points


def livox_case(name, folder, random):
    """Packets after Livox-SDK2's LivoxLidarEthernetPacket: 36 bytes of head, then mm in 32 or cm in 16 bits."""
    high = name == "cartesian high"
    count = 96
    packets, points = [], Points()
    for number in range(700):
        time = 5_000_000_000 + 480_000 * number + int(random.integers(0, 1000))
        most = 70_000 if high else 12_000
        xyz = random.integers(-most, most, (count, 3))
        xyz[random.random(count) < 0.1] = 0  # no return
        values = random.integers(0, 256, count)
        tags = random.choice([0x00, 0x04, 0x10, 0x20, 0x30], count)
        interval = 4750 + int(random.integers(0, 50))  # 0.1 µs
        body = b"".join(struct.pack("<iiiBB" if high else "<hhhBB", *one)
                        for one in np.column_stack([xyz, values, tags]).tolist())
        head = struct.pack("<BHHHHBBB12xI", 0, 36 + len(body), interval, count, number & 0xffff, 0, 1 if high else 2, 0,
                           0)
        packets.append((time, head + struct.pack("<Q", BEGIN + time) + body))
        kept = xyz.any(axis=1) & ((tags & 0x30) <= 0x10)  # of high or moderate confidence
        points.add(xyz[kept] * (1e-3 if high else 1e-2), values[kept],
                   time + 100 * interval / count * np.arange(count)[kept])
    capture = folder / f"livox_{name.replace(' ', '_')}.pcap"
    write_capture(capture, packets, 56301)
    return Case(f"Livox {name}", "what was put in", capture, lambda: points)


def cases(folder, random):
    for profile in ["LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8",
                    "RNG15_RFL8_NIR8_DUAL", "FUSA_RNG15_RFL8_NIR8_DUAL"]:
        yield f"Ouster {profile}", lambda profile=profile: ouster_case(profile, folder, random)
    for model in ("VLP-16", "HDL-32E", "VLP-32C", "VLS-128"):
        for dual in (False, True):
            for manual in (False, True):
                yield (f"Velodyne {model}{' dual' if dual else ''}",
                       lambda model=model, dual=dual, manual=manual: velodyne_case(model, dual, manual, folder, random))
    for name in ("cartesian high", "cartesian low"):
        yield f"Livox {name}", lambda name=name: livox_case(name, folder, random)
    yield from hesai_cases(folder, random)


def compare(adit, case):
    """Prints a row; true where they agree."""
    theirs, ours = ([part[points[2] >= case.begin] for part in points]
                    for points in (case.theirs().arrays(), read_ours(adit, case).arrays()))
    row = f"{case.name:<36} {case.other:<16} {len(theirs[2]):>7} {len(ours[2]):>7}"
    if len(theirs[2]) != len(ours[2]):
        print(f"{row}  the numbers differ", flush=True)
        return False
    position = np.linalg.norm(theirs[0] - ours[0], axis=1).max()
    intensity, moment = (np.abs(theirs[i] - ours[i]).max() for i in (1, 2))
    equal = position <= case.tolerance and moment <= 1e9 * case.time_tolerance and intensity == 0
    print(f"{row} {1e6 * position:>9.2f} {moment:>10.1f} {intensity:>9.0f}  {'' if equal else 'DIFFERENT '}{case.note}",
          flush=True)
    return equal


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("adit", type=lambda path: pathlib.Path(path).absolute())
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="cases whose name has this in it")
    parser.add_argument("--folder", type=pathlib.Path, help="where the captures stay; otherwise they are removed")
    arguments = parser.parse_args()
    os.environ["TZ"] = "UTC"
    time.tzset()
    print(f"{'sensor, profile':<36} {'other':<16} {'theirs':>7} {'ours':>7} {'µm':>9} {'ns':>10} {'intensity':>9}")
    found = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name, make in cases(folder, np.random.default_rng(arguments.seed)):
            if arguments.only in name:
                found.append(compare(arguments.adit, make()))
    equal = bool(found) and all(found)
    print("all equal" if equal else "not all equal")
    return 0 if equal else 1


if __name__ == "__main__":
    sys.exit(main())
