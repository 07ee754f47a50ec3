# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Packet captures for sensor_sdks.py and the points that another program finds in them."""

import dataclasses
import pathlib
import struct
import typing

import numpy as np

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
    begin: float = 0.0  # ns after BEGIN; points before that are not compared


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
