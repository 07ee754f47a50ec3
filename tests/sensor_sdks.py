#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Compares how `adit` reads the packets of lidars with what other programs make of them.

Usage: sensor_sdks.py ADIT [--seed S] [--only WORD] [--folder FOLDER]. It needs ouster-sdk, velodyne-decoder, hydra4,
mcap, rosbags and numpy from PyPI. For each case it writes a packet capture with random ranges, has `adit convert
--repair` turn it into point clouds, and compares number, positions, intensities and times of the points. Ouster's
packets are written and read by ouster-sdk; Velodyne's are written here and read by velodyne-decoder, Hesai's by hydra4.
Livox's, and rows of "its manual", are written and worked out here, after the makers' manuals. Exits 1 where a case
differs.
"""

import argparse
import dataclasses
import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time
import types
import typing

try:
    import numpy as np
    import velodyne_decoder as vd
    from hydra4.hydra4 import Hydra
    from mcap.reader import make_reader
    from ouster.sdk import core
    from ouster.sdk.pcap import PcapPacketSource
    from rosbags.typesys import Stores, get_typestore
except ImportError as error:
    packages = "ouster-sdk velodyne-decoder hydra4 mcap rosbags numpy"
    print(f"sensor_sdks.py: {error}; pip install {packages}", file=sys.stderr)
    sys.exit(2)

BEGIN = 1_699_999_200 * 10**9  # ns, a whole hour: 2023-11-14, 22:00:00
SINGLE, DUAL = 0x37, 0x39  # modes of return, Velodyne's and Hesai's


@dataclasses.dataclass
class Case:
    """A capture, what belongs to it, and what gives the points that another program finds in it."""

    name: str
    other: str
    capture: pathlib.Path
    theirs: typing.Callable
    metadata: pathlib.Path = None
    tolerance: float = 1e-5  # m
    time_tolerance: float = 1e-8  # s
    note: str = ""


class Points:
    """Positions (m), intensities and times (ns after BEGIN) of points, in the order of firing."""

    def __init__(self):
        self.positions, self.intensities, self.times = [], [], []

    def add(self, positions, intensities, times):
        self.positions.append(np.asarray(positions, dtype=np.float64))
        self.intensities.append(np.asarray(intensities, dtype=np.float64))
        self.times.append(np.asarray(times, dtype=np.float64))

    def arrays(self):
        return [np.concatenate(parts) for parts in (self.positions, self.intensities, self.times)]


def frames_of(payload, port, number):
    """Ethernet frames of a datagram, in fragments as on a real network."""
    udp, most = struct.pack("!HHHH", 4000, port, 8 + len(payload), 0) + payload, 1480
    for at in range(0, len(udp), most):
        part = udp[at:at + most]
        flags = (0x2000 if at + most < len(udp) else 0) | at // 8
        ip = struct.pack("!BBHHHBBH4s4s", 0x45, 0, 20 + len(part), number & 0xffff, flags, 64, 17, 0,
                         bytes([192, 168, 1, 201]), bytes([192, 168, 1, 10]))
        total = sum(struct.unpack("!10H", ip))
        total = (total & 0xffff) + (total >> 16)
        checksum = ~((total & 0xffff) + (total >> 16)) & 0xffff
        yield bytes(12) + b"\x08\x00" + ip[:10] + struct.pack("!H", checksum) + ip[12:] + part


def write_capture(path, packets, port):
    """`packets`: time of reception (ns after BEGIN) and payload."""
    with open(path, "wb") as file:
        file.write(struct.pack("<IHHiIII", 0xa1b23c4d, 2, 4, 0, 0, 262144, 1))
        for number, (received, payload) in enumerate(packets):
            stamp = BEGIN + int(received)
            for frame in frames_of(payload, port, number):
                file.write(struct.pack("<IIII", stamp // 10**9, stamp % 10**9, len(frame), len(frame)) + frame)


NUMPY_OF = {1: "i1", 2: "u1", 3: "<i2", 4: "<u2", 5: "<i4", 6: "<u4", 7: "<f4", 8: "<f8"}


def cloud_of(message):
    assert not message.is_bigendian and message.row_step == message.point_step * message.width
    kind = np.dtype({"names": [field.name for field in message.fields],
                     "formats": [NUMPY_OF[field.datatype] for field in message.fields],
                     "offsets": [field.offset for field in message.fields], "itemsize": message.point_step})
    return message.data.view(kind)


def convert(adit, case):
    out = case.capture.with_suffix(".mcap")
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


class Velodyne:
    """A model after its manual; the seconds of a firing of all lasers, and of one laser after the other."""

    def __init__(self, model):
        self.model = model
        if model == "VLP-16":
            self.code, self.lasers, self.cycle, self.step, self.degrees = 0x22, 16, 55.296e-6, 2.304e-6, 0.48
            self.elevations = np.array([i if i % 2 else i - 15 for i in range(16)])
            self.heights = -1e-4 * np.round(419.1 * np.tan(np.radians(self.elevations)))
        else:
            self.code, self.lasers, self.cycle, self.step, self.degrees = 0x21, 32, 46.08e-6, 1.152e-6, 0.40
            self.elevations = np.array([(-28 if i % 2 else -92) / 3 + 4 / 3 * (i // 2) for i in range(32)]).round(2)
            self.heights = np.zeros(32)
        self.block_time = self.cycle * 32 / self.lasers

    def points(self, azimuth, ranges):
        """Positions of a block, and seconds after it began."""
        within = self.cycle * (np.arange(32) // self.lasers) + self.step * (np.arange(32) % self.lasers)
        angle = np.radians(azimuth + self.degrees * within / self.block_time)
        laser = np.arange(32) % self.lasers
        elevation = np.radians(self.elevations[laser])
        flat = 2e-3 * ranges * np.cos(elevation)
        return np.stack([flat * np.cos(angle), -flat * np.sin(angle),
                         2e-3 * ranges * np.sin(elevation) + self.heights[laser]], axis=1), within


def velodyne_case(model, dual, manual, folder, random):
    """Data packets after the manuals of VLP-16 and HDL-32E: twelve blocks of an azimuth and 32 ranges of 2 mm.

    It turns by 0.01 degrees from a laser to the next, as velodyne-decoder rounds azimuths to that: 9 mm at 100 m. What
    it makes of them is up to 0.7 µrad off, 70 µm at 100 m, and its heights of VLP-16's lasers differ from the
    manual's, which are rounded, by 30 µm.
    """
    sensor = Velodyne(model)
    firings = 6 if dual else 12
    packets, points = [], Points()
    for number in range(int(3.2 * 360 / sensor.degrees / firings)):
        micros = 5_000_000 + round(1e6 * number * firings * sensor.block_time)
        packet = b""
        for block in range(12):
            turn = block // 2 if dual else block
            azimuth = round(100 * (30.0 + sensor.degrees * (number * firings + turn))) % 36000
            fresh = random.integers(250, 50_000, 32)
            fresh[random.random(32) < 0.15] = 0
            values = random.integers(0, 256, 32)
            kept = fresh > 0
            if dual and block % 2 == 1:  # the same return once more where there is no other
                same = (random.random(32) < 0.4) | (ranges == 0) | (ranges == fresh)
                fresh, values = np.where(same, ranges, fresh), np.where(same, strengths, values)
                kept &= ~same
            ranges, strengths = fresh, values
            packet += struct.pack("<HH", 0xeeff, azimuth)
            packet += b"".join(struct.pack("<HB", *one) for one in zip(ranges.tolist(), strengths.tolist()))
            xyz, within = sensor.points(1e-2 * azimuth, ranges)
            points.add(xyz[kept], strengths[kept], 1000 * micros + 1e9 * (sensor.block_time * turn + within[kept]))
        packets.append((1000 * micros, packet + struct.pack("<IBB", micros, DUAL if dual else SINGLE, sensor.code)))
    name = f"{model}{' dual' if dual else ''}"
    capture = folder / f"velodyne_{name.replace(' ', '_')}.pcap"
    write_capture(capture, packets, 2368)
    if manual:
        return Case(f"Velodyne {name}", "its manual", capture, lambda: points)
    return Case(f"Velodyne {name}", "velodyne-decoder", capture, lambda: velodyne_points(model, capture),
                tolerance=100e-6, time_tolerance=500e-9, note="heights taken out" if model == "HDL-32E" else "")


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
        cloud = cloud[np.lexsort((cloud["return_type"] == vd.ReturnMode.STRONGEST.value, pair))]
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


DATE = bytes([2023 - 1900, 11, 14, 22, 0])  # up to the minutes of BEGIN


@dataclasses.dataclass
class Hesai:
    """How packets of a model look: PandarXT (6.1), OT128 (1.4) and Pandar64, after the manuals of these."""

    model: str
    blocks: int
    lasers: int
    step: float  # degrees from a firing to the next
    firing: int  # ns from a firing to the next
    elevations: np.ndarray
    azimuths: np.ndarray
    other: str = "hydra4"

    def packet(self, azimuths, ranges, values, dual, micros, motor):
        """Blocks of an azimuth (0.01 degrees) with a range (4 mm) and a reflectivity for each laser."""
        body, mode, returns = b"", DUAL if dual else SINGLE, 2 if dual else 1
        for azimuth, row, strengths in zip(azimuths, ranges.tolist(), values.tolist()):
            more = [0] if self.model == "XT" else []
            layout = "<HBB" if more else "<HB"
            body += struct.pack("<H", azimuth)
            body += b"".join(struct.pack(layout, *one, *more) for one in zip(row, strengths))
        date = DATE + bytes([micros // 1_000_000])
        clock = struct.pack("<I", micros % 1_000_000)
        if self.model == "Pandar64":
            tail = bytes(8) + struct.pack("<H", motor) + clock + bytes([mode, 0x42]) + date
            return bytes([0xee, 0xff, self.lasers, self.blocks, 0, 4, 0, 0]) + body + tail
        if self.model == "XT":
            head = bytes([0xee, 0xff, 6, 1, 0, 0, self.lasers, self.blocks, 0, 4, returns, 1])
            tail = bytes(10) + struct.pack("<BH", mode, motor) + date + clock + b"\x42" + bytes(4)
        else:  # high resolution; a block's state of azimuth is 0 and 1
            head = bytes([0xee, 0xff, 1, 4, 0, 0, self.lasers, self.blocks, 0, 4, returns, 0])
            body += bytes(4)
            tail = bytes(9) + struct.pack("<HBBH", 0x1000, 0, mode, motor) + date + clock + bytes(56 - 25)
        return head + body + tail

    def times(self, packet_time, dual):
        """ns of a packet's blocks and lasers, as the manuals give them."""
        after = (self.blocks - 1 - np.arange(self.blocks)) // (2 if dual else 1)
        blocks = packet_time - self.firing * after[:, None]
        if self.model == "XT":
            return blocks + 5632 + 280 + 1512 * np.arange(self.lasers)
        return blocks + np.zeros(self.lasers)


def hesai_case(name, sensor, dual, metadata, folder, random, note=""):
    """Turns of 30 degrees about azimuth 0, as of a sensor with a narrow field of view."""
    per_packet = sensor.blocks // 2 if dual else sensor.blocks
    packets, points = [], Points()
    elevations = np.radians(sensor.elevations)
    for turn in range(4):
        for number in range(round(30.0 / sensor.step / per_packet)):
            first = 34_500 + 100 * sensor.step * per_packet * number
            azimuths = [round(first + 100 * sensor.step * (block // (2 if dual else 1))) % 36000
                        for block in range(sensor.blocks)]
            ranges = random.integers(100, 30_000, (sensor.blocks, sensor.lasers))
            ranges[random.random(ranges.shape) < 0.1] = 0
            values = random.integers(0, 256, ranges.shape)
            kept = ranges > 0
            if dual:
                same = (random.random(ranges[::2].shape) < 0.3) | (ranges[::2] == 0)
                ranges[1::2][same], values[1::2][same] = ranges[::2][same], values[::2][same]
                kept = ranges > 0
                kept[1::2] &= ranges[1::2] != ranges[::2]
            micros = 5_000_000 + 100_000 * turn + round(1e-3 * sensor.firing * per_packet * number)
            packets.append((1000 * micros, sensor.packet(azimuths, ranges, values, dual, micros, 600)))
            azimuth = np.radians(1e-2 * np.asarray(azimuths)[:, None] + sensor.azimuths)
            flat, height = 4e-3 * ranges * np.cos(elevations), 4e-3 * ranges * np.sin(elevations)
            xyz = np.stack([flat * np.sin(azimuth), flat * np.cos(azimuth), height], axis=-1)
            points.add(xyz[kept], values[kept], sensor.times(1000 * micros, dual)[kept])
    capture = folder / f"hesai_{name.replace(' ', '_').replace(',', '')}.pcap"
    write_capture(capture, packets, 2368)
    tolerance = {"XT": 10e-9, "OT128": 30e-6, "Pandar64": 1e-6}[sensor.model]

    def theirs():
        if sensor.other != "hydra4":
            return points
        return hydra_points(sensor, dual, packets, metadata or hesai_angles(sensor, folder), points.arrays()[2])

    return Case(f"Hesai {name}", sensor.other, capture, theirs, metadata, time_tolerance=tolerance, note=note)


def hesai_angles(sensor, folder):
    """An angle correction file."""
    file = folder / f"angles_{sensor.model}_{sensor.lasers}.csv"
    rows = [f"{i + 1},{one[0]:.6f},{one[1]:.6f}" for i, one in enumerate(zip(sensor.elevations, sensor.azimuths))]
    file.write_text("\n".join(["Channel,Elevation,Azimuth", *rows]) + "\n")
    return file


def hydra_points(sensor, dual, packets, angles, by_manual):
    """Times are hydra4's for OT128. For XT they are not: it takes the microseconds between blocks for seconds."""
    model = Hydra.Model.PandarXT32 if sensor.model == "XT" else Hydra.Model.PandarOT128
    decoder = model.decoder(angles, 0.0, 1000.0)
    rows = []
    for _, payload in packets:
        earlier = set()
        for i, block in enumerate(decoder(types.SimpleNamespace(data=payload))):
            found = block.points
            if dual and i % 2 == 1:  # a return once more counts once
                found = [point for point in found if (*point[:3], point[4]) not in earlier]
            earlier = {(*point[:3], point[4]) for point in block.points}
            rows += found
    table = np.array([[*point[:4], point[6] - BEGIN // 10**9] for point in rows])
    points = Points()
    points.add(table[:, :3], table[:, 3], by_manual if sensor.model == "XT" else 1e9 * table[:, 4])
    return points


def hesai_cases(folder, random):
    def random_angles(lasers, lowest, spread):
        return {"elevations": (np.linspace(15, lowest, lasers) + random.normal(0, 0.05, lasers)).round(6),
                "azimuths": random.normal(0, spread, lasers).round(6)}

    design = {"elevations": 15.0 - np.arange(32), "azimuths": np.zeros(32)}
    tilted, many, fewer = random_angles(32, -16, 0.1), random_angles(128, -25, 1.0), random_angles(64, -25, 1.0)
    manual, blocks = "times after the manual", "adit tells times of blocks only"
    for name, sensor, dual, corrected, note in [
            ("XT-32", Hesai("XT", 8, 32, 0.18, 50_000, **design), False, False, manual),
            ("XT-32, corrected angles", Hesai("XT", 8, 32, 0.18, 50_000, **tilted), False, True, manual),
            ("XT-32 dual", Hesai("XT", 8, 32, 0.18, 50_000, **design, other="its manual"), True, False, ""),
            ("OT128", Hesai("OT128", 2, 128, 0.1, 27_778, **many), False, True, blocks),
            ("OT128 dual", Hesai("OT128", 2, 128, 0.1, 27_778, **many), True, True, blocks),
            ("Pandar64", Hesai("Pandar64", 6, 64, 0.2, 55_556, **fewer, other="its manual"), False, True,
             "times of blocks, of both")]:
        yield f"Hesai {name}", lambda name=name, sensor=sensor, dual=dual, corrected=corrected, note=note: hesai_case(
            name, sensor, dual, hesai_angles(sensor, folder) if corrected else None, folder, random, note)


def cases(folder, random):
    for profile in ["LEGACY", "RNG19_RFL8_SIG16_NIR16", "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8",
                    "RNG15_RFL8_NIR8_DUAL", "FUSA_RNG15_RFL8_NIR8_DUAL"]:
        yield f"Ouster {profile}", lambda profile=profile: ouster_case(profile, folder, random)
    for model in ("VLP-16", "HDL-32E"):
        for dual in (False, True):
            for manual in (False, True):
                yield (f"Velodyne {model}{' dual' if dual else ''}",
                       lambda model=model, dual=dual, manual=manual: velodyne_case(model, dual, manual, folder, random))
    for name in ("cartesian high", "cartesian low"):
        yield f"Livox {name}", lambda name=name: livox_case(name, folder, random)
    yield from hesai_cases(folder, random)


def compare(adit, case):
    """Prints a row; true where they agree."""
    theirs, ours = case.theirs().arrays(), read_ours(adit, case).arrays()
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
