#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How many points that are of no surface `adit export --dense las --clean mark` finds, and what it costs.

Usage: false_points.py ADIT... -o FOLDER [--scenes NAME...] [--seeds N...]. The first program simulates scenes and maps
them; each one exports every return with its class. So two programs are compared on the same maps. What FOLDER holds
already of a scene and seed is not made again, but for the export.

The carrier of the sensor is in view everywhere; the panes of the office mirror. Truth: NAME.truth.surfaces (0: melted of
two surfaces, dust; 127: mirrored; 126: carrier) and NAME.truth.labels. One line a scene and program: of each kind its
share of all returns, and the share of it with one of the classes 7, 18, 64 to 66; at last the share of all other
returns that has one: the median of the seeds, and in brackets the worst.

Exit codes: 0 done, 1 a command failed, 2 usage.
"""

import argparse
import pathlib
import statistics
import sys

try:
    import numpy as np
except ImportError as error:
    print(f"false_points.py: {error}; pip install numpy", file=sys.stderr)
    sys.exit(2)

from clean_clouds import adit, read_las

MARKED = (7, 18, 64, 65, 66)
MIRRORED, CARRIER = 127, 126
# Scene: way of moving, and more for `adit simulate`.
SCENES = {"office": ("walk", "--reflections"), "city": ("drive",), "mine": ("drive",)}
KINDS = ("mirrored", "mixed, dust", "moving", "carrier")


def measure(programs, folder, scene, seed, duration):
    """By program: of each kind its share of the returns (%), the share found (%); the share lost of the rest (%)."""
    trajectory, *more = SCENES[scene]
    recording, out = folder / f"{scene}-{seed}.mcap", folder / f"{scene}-{seed}"
    if not recording.exists():
        adit(programs[0], "simulate", scene, "--trajectory", trajectory, "--duration", duration, "--seed", seed,
             "--fault", "own-carrier", *more, "--quiet", "-o", recording)
    if not (out / "summary.json").exists():
        adit(programs[0], "run", recording, "-o", out, "--overwrite", "--quiet")
    surfaces = np.fromfile(recording.with_suffix(".truth.surfaces"), np.uint8)
    labels = recording.with_suffix(".truth.labels")
    moves = np.fromfile(labels, "<u2") > 0 if labels.exists() else np.zeros(len(surfaces), bool)
    kinds = (surfaces == MIRRORED, (surfaces == 0) & ~moves, moves & (surfaces < CARRIER), surfaces == CARRIER)
    results = []
    for program in programs:
        las = folder / f"{scene}-{seed}.las"
        adit(program, "export", out, "--dense", "las", "--clean", "mark", "-o", las)
        marked = np.isin(read_las(las)[1], MARKED)
        if len(marked) != len(surfaces):
            sys.exit(f"false_points.py: {recording}: {len(surfaces)} surfaces for {len(marked)} returns")
        las.unlink()
        rest = ~np.any(kinds, axis=0)
        results.append([[100 * kind.mean(), 100 * marked[kind].mean() if kind.any() else None] for kind in kinds]
                       + [[100 * rest.mean(), 100 * marked[rest].mean()]])
    return results


def text(values, worst):
    known = [value for value in values if value is not None]
    return f"{statistics.median(known):.2f} ({worst(known):.2f})" if known else "-"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+", help="adit; others that export the same maps")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="folder for recordings and maps")
    parser.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    parser.add_argument("--seeds", nargs="+", type=int, default=[7605, 7606, 7607, 7608, 7609])
    parser.add_argument("--duration", type=float, default=12.0, help="s")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    print("| scene | program | " + " | ".join(f"{kind}, % | found, %" for kind in KINDS) + " | lost of the rest, % |")
    print("|---|---|" + "---|" * (2 * len(KINDS) + 1))
    for scene in options.scenes:
        runs = [measure(options.programs, options.output, scene, seed, options.duration) for seed in options.seeds]
        for i, program in enumerate(options.programs):
            cells = []
            for k in range(len(KINDS)):
                cells.append(f"{statistics.median(run[i][k][0] for run in runs):.3f}")
                cells.append(text([run[i][k][1] for run in runs], min))
            cells.append(text([run[i][-1][1] for run in runs], max))
            print(f"| {scene} | {pathlib.Path(program).name} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
