# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Packets of Hesai's sensors for sensor_sdks.py, and their points by hydra4 or by the maker's formulas.

hydra4 reads PandarXT-32 and OT128 alone. The others are worked out here after Hesai's manuals and the firetime
correction files of HesaiLidar_SDK_2.0.
"""

import dataclasses
import struct
import types

import numpy as np
from hydra4.hydra4 import Hydra

from sensor_captures import BEGIN, DUAL, SINGLE, Case, Points, write_capture

DATE = bytes([2023 - 1900, 11, 14, 22, 0])  # up to the minutes of BEGIN


@dataclasses.dataclass
class Hesai:
    """How packets of a model look: PandarXT (6.1), OT128 (1.4) and Pandar64, after the manuals of these."""

    TOLERANCE = {"XT": 10e-9, "OT128": 30e-6, "Pandar64": 1e-6}  # s

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

    def turned(self, dual):
        """ns that the rotor turned on since a block's azimuth was read, of its lasers. XT's are not known to adit."""
        return np.zeros((self.blocks, self.lasers))


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
            rotor = 1e-2 * np.asarray(azimuths)[:, None] + 3600e-9 * sensor.turned(dual)  # at 600 turns a minute
            azimuth = np.radians(rotor + sensor.azimuths)
            flat, height = 4e-3 * ranges * np.cos(elevations), 4e-3 * ranges * np.sin(elevations)
            xyz = np.stack([flat * np.sin(azimuth), flat * np.cos(azimuth), height], axis=-1)
            points.add(xyz[kept], values[kept], sensor.times(1000 * micros, dual)[kept])
    capture = folder / f"hesai_{name.replace(' ', '_').replace(',', '')}.pcap"
    write_capture(capture, packets, 2368)
    tolerance = sensor.TOLERANCE.get(sensor.model, 10e-9)

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


@dataclasses.dataclass
class Fired(Hesai):
    """A model whose lasers have firing times; `first` is the ns from a packet's time to its first or last block."""

    first: int = 0
    from_last: bool = False
    read: int = 0  # ns after a block began, when its azimuth was read
    firings: tuple = ()  # ns after a block began, by channel; of two firing sequences in turn
    sequence: int = 1  # of a packet with dual returns

    def packet(self, azimuths, ranges, values, dual, micros, motor):
        mode, date = DUAL if dual else SINGLE, DATE + bytes([micros // 1_000_000])
        clock, speed = struct.pack("<I", micros % 1_000_000), struct.pack("<H", motor)
        rest = b"" if self.model == "Pandar40P" else b"\x5a"
        body = b""
        for azimuth, row, strengths in zip(azimuths, ranges.tolist(), values.tolist()):
            body += (b"\xff\xee" if self.model == "Pandar40P" else b"") + struct.pack("<H", azimuth)
            body += b"".join(struct.pack("<HB", *one) + rest for one in zip(row, strengths))
        if self.model == "Pandar40P":
            return body + bytes(8) + speed + clock + bytes([mode, 0x42]) + date
        version = {"PandarQT64": (3, 1, 1), "QT128C2X": (3, 2, 0x0f), "XT32M2X": (6, 1, 1)}[self.model]
        head = bytes([0xee, 0xff, *version[:2], 0, 0, self.lasers, self.blocks, 0, 4, 2 if dual else 1, version[2]])
        if self.model == "PandarQT64":
            return head + body + bytes(10) + speed + clock + bytes([mode, 0x42]) + date + bytes(4)
        if self.model == "XT32M2X":
            return head + body + bytes(10) + bytes([mode]) + speed + date + clock + b"\x42" + bytes(4)
        tail = bytes(5) + bytes([self.sequence]) + bytes(6) + bytes([mode]) + speed + date + clock + b"\x42"
        return head + body + bytes(4) + bytes(17) + tail + bytes(4) + bytes(4) + bytes(32)

    def of_blocks(self, dual):
        """Firing times of the blocks' lasers, after the begin of each."""
        if len(self.firings) == 1:
            return np.repeat([self.firings[0]], self.blocks, axis=0)
        return np.array([self.firings[(1 - self.sequence) if dual else block % 2] for block in range(self.blocks)])

    def times(self, packet_time, dual):
        number = np.arange(self.blocks) // (2 if dual else 1)
        begin = self.firing * (number - number[-1] if self.from_last else number)
        return packet_time + self.first + begin[:, None] + self.of_blocks(dual)

    def turned(self, dual):
        return self.of_blocks(dual) - self.read


# Channels of QT128C2X in the order in which they fire: 3 times 856 ns and 1456 ns apart, from 600 ns on.
FIRST_ORDER = [
    99, 65, 35, 102, 72, 38, 107, 73, 43, 110, 80, 46, 115, 81, 51, 118, 88, 54, 123, 89, 59, 126, 96, 62, 97, 67,
    33, 104, 70, 40, 105, 75, 41, 112, 78, 48, 113, 83, 49, 120, 86, 56, 121, 91, 57, 128, 94, 64, 98, 68, 34, 103,
    69, 39, 106, 76, 42, 111, 77, 47, 114, 84, 50, 119, 85, 55, 122, 92, 58, 127, 93, 63, 100, 66, 36, 101, 71, 37,
    108, 74, 44, 109, 79, 45, 116, 82, 52, 117, 87, 53, 124, 90, 60, 125, 95, 61
]
SECOND_ORDER = [
    65, 99, 1, 72, 102, 8, 73, 107, 9, 80, 110, 16, 81, 115, 17, 88, 118, 24, 89, 123, 25, 96, 126, 32, 67, 97, 3,
    70, 104, 6, 75, 105, 11, 78, 112, 14, 83, 113, 19, 86, 120, 22, 91, 121, 27, 94, 128, 30, 68, 98, 4, 69, 103, 5,
    76, 106, 12, 77, 111, 13, 84, 114, 20, 85, 119, 21, 92, 122, 28, 93, 127, 29, 66, 100, 2, 71, 101, 7, 74, 108,
    10, 79, 109, 15, 82, 116, 18, 87, 117, 23, 90, 124, 26, 95, 125, 31
]
BEFORE_END_40P = [  # us before the end of a block
    42.22, 28.47, 16.04, 3.62, 45.49, 31.74, 47.46, 54.67, 20.62, 33.71, 40.91, 8.19, 20.62, 27.16, 50.73, 8.19,
    14.74, 36.98, 45.49, 52.7, 23.89, 31.74, 38.95, 11.47, 18.65, 25.19, 48.76, 6.23, 12.77, 35.01, 21.92, 9.5,
    43.52, 29.77, 17.35, 4.92, 42.22, 28.47, 16.04, 3.62
]
FIRETIMES_QT64 = [  # us
    2.31, 4.37, 6.43, 8.49, 10.54, 12.6, 14.66, 16.71, 19.16, 21.22, 23.28, 25.34, 27.39, 29.45, 31.5, 33.56, 36.61,
    38.67, 40.73, 42.78, 44.84, 46.9, 48.95, 51.01, 53.45, 55.52, 57.58, 59.63, 61.69, 63.74, 65.8, 67.86, 70.9,
    72.97, 75.02, 77.08, 79.14, 81.19, 83.25, 85.3, 87.75, 89.82, 91.87, 93.93, 95.98, 98.04, 100.1, 102.15, 105.2,
    107.26, 109.32, 111.38, 113.43, 115.49, 117.54, 119.6, 122.05, 124.11, 126.17, 128.22, 130.28, 132.34, 134.39,
    136.45
]
ELEVATIONS_40P = [15, 11, 8, 5, 3, 2, *[round(5 / 3 - i / 3, 2) for i in range(24)], *range(-7, -15, -1), -19, -25]
ELEVATIONS_40P[16] = -1.66  # as published
AZIMUTHS_40P = [-1.042] * 6 + [3.125, -5.208, -1.042] * 8 + [-1.042] * 10


def firing_of_order(order):
    firing = np.zeros(128)
    firing[np.array(order) - 1] = [600 + 3168 * (i // 3) + 856 * (i % 3) for i in range(96)]
    return firing


def fired(model, elevations, azimuths):
    """A model of that name with these angles."""
    angles = {"elevations": elevations, "azimuths": azimuths, "other": "maker's formula"}
    if model == "Pandar40P":
        firing = 54_670 - 1000 * np.array(BEFORE_END_40P)
        return Fired(model, 10, 40, 0.2, 55_560, **angles, first=-28_580 - 54_670, from_last=True, read=54_670,
                     firings=(firing,))
    if model == "PandarQT64":
        firing = 10_000 + 1000 * np.array(FIRETIMES_QT64)
        return Fired(model, 4, 64, 0.6, 166_667, **angles, first=25_710, read=10_000, firings=(firing,))
    if model == "XT32M2X":
        firing = 368 + 2888 * (np.arange(32) % 16)
        return Fired(model, 6, 32, 0.18, 50_000, **angles, first=5632, from_last=True, read=-5632, firings=(firing,))
    return Fired(model, 2, 128, 0.4, 111_110, **angles, first=9000,
                 firings=(firing_of_order(FIRST_ORDER), firing_of_order(SECOND_ORDER)))


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
    own = {"Pandar40P": random_angles(40, -25, 2.0), "PandarQT64": random_angles(64, -52, 5.0),
           "QT128C2X": random_angles(128, -52, 5.0), "XT32M2X": random_angles(32, -20, 0.1)}
    for model, angles in own.items():
        for dual in (False, True):
            yield f"Hesai {model}", lambda sensor=fired(model, **angles), dual=dual: hesai_case(
                f"{sensor.model}{' dual' if dual else ''}, corrected angles", sensor, dual,
                hesai_angles(sensor, folder), folder, random)
    for sensor in (fired("Pandar40P", np.array(ELEVATIONS_40P), np.array(AZIMUTHS_40P)),
                   fired("XT32M2X", 19.5 - 1.3 * np.arange(32), np.zeros(32))):
        yield f"Hesai {sensor.model}", lambda sensor=sensor: hesai_case(
            f"{sensor.model}, angles of the design", sensor, False, None, folder, random)
