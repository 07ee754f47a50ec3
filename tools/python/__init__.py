# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Range-inertial-GNSS SLAM on any Vulkan device.

    recording = adit.open("drive.mcap")
    slam = adit.Slam.for_recording(recording, map="drive.adit")
    for sweep in slam.process(recording):
        print(sweep.stamp, sweep.pose[:3, 3])
    slam.finish_map()

Poses are (4, 4) float64 and named T_a_b: they map coordinates in b to a. Points are (n, 4) float32, x y z in m and the
sensor's intensity. Stamps are whole nanoseconds. Arguments may be arrays of any number type, or lists; adit copies them once.
Errors are subclasses of adit.Error, with the program's own messages; arguments without numbers or of a wrong shape
raise TypeError and ValueError. Work on the device releases the GIL. Measurements, results and Config pickle. A device
does not survive a fork: start processes with multiprocessing.get_context("spawn").
"""

from __future__ import annotations

import atexit
import functools
from typing import Any, Iterable, Literal, Optional, Sequence, Union

import numpy.typing as npt

from ._adit import (Aligner, Alignment, BodyVelocity, Config, Device, DeviceError, DoubtfulStretch, Edge, Error,
                    Evaluation, EventIterator, Georeference, GnssFix, Heading, ImuSample, InertialReport, InputError,
                    Keyframe, LidarMotion, Loop, Map, MapFix, MapReport, MapSession, ObservedDirection, Odometry, OutputError,
                    PlacedSweeps, ReadingTaken, Recording, ReferencePose, RegistrationResult, SimulationSummary, Slam,
                    StaticTransform, Statistics, Submap, Surfaces, Sweep, SweepLeftOut, SweepPlaced, SweepResult, Topic,
                    Trajectory, UsageError, Verdict, devices, estimate_surfaces, evaluate, open, presets, simulate,
                    version, voxel_down_sample)

__version__ = version()

_Array = npt.ArrayLike  # of numbers
_Method = Literal["vgicp", "ndt", "point-to-plane", "ndt-to-ndt"]

__all__ = [
    "Aligner", "Alignment", "BodyVelocity", "Config", "Device", "DeviceError", "DoubtfulStretch", "Edge", "Error",
    "Evaluation", "EventIterator", "Georeference", "GnssFix", "Heading", "ImuSample", "InertialReport", "InputError",
    "Keyframe", "LidarMotion", "Loop", "Map", "MapFix", "MapReport", "MapSession", "ObservedDirection", "Odometry", "OutputError",
    "PlacedSweeps", "ReadingTaken", "Recording", "ReferencePose", "RegistrationResult", "SimulationSummary", "Slam",
    "StaticTransform", "Statistics", "Submap", "Surfaces", "Sweep", "SweepLeftOut", "SweepPlaced", "SweepResult",
    "Topic", "Trajectory", "UsageError", "Verdict", "align", "align_batch", "devices", "estimate_surfaces", "evaluate",
    "open", "presets", "simulate", "version", "voxel_down_sample"
]


@functools.lru_cache(maxsize=4)
def _aligner(method: _Method, resolution: float, min_overlap: float, device: Union[str, Device, None]) -> Aligner:
    return Aligner(method=method, resolution=resolution, min_overlap=min_overlap, device=device)


atexit.register(_aligner.cache_clear)  # before the device is closed


def align(a: _Array, b: _Array, guess: Optional[_Array] = None, *, method: _Method = "vgicp", resolution: float = 0.0,
          min_overlap: float = 0.4, device: Union[str, Device, None] = None) -> Alignment:
    """The relative pose T_a_b of two clouds, as Aligner.align(); its arguments are those of Aligner."""
    return _aligner(method, resolution, min_overlap, device).align(a, b, guess)


def align_batch(pairs: Iterable[Sequence[Any]], *, method: _Method = "vgicp", resolution: float = 0.0,
                min_overlap: float = 0.4, device: Union[str, Device, None] = None) -> list[Alignment]:
    """Many pairs at once, (a, b) or (a, b, guess) each, as Aligner.align_batch()."""
    return _aligner(method, resolution, min_overlap, device).align_batch(pairs)
