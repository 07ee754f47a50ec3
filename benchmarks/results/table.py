#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Makes the table of benchmarks in benchmarks/README.md from the JSON files beside this script.

Usage: table.py [--write]. Prints the table; --write puts it into that file between its marks.
"""

import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
README = HERE.parent / "README.md"
BEGIN = "<!-- benchmarks: begin -->\n"
END = "<!-- benchmarks: end -->\n"
# Case, size, and what it is for people.
ROWS = [
    ("downsample", 120000, "down-sampling a sweep of {size} raw points"),
    ("surfaces", 120000, "surfaces of the {items} points left"),
    ("voxel-map/add", 120000, "adding them to a Gaussian voxel map"),
    ("linearize/vgicp", 120000, "one VGICP linearisation and step"),
    ("linearize/vgicp", 1000000, "the same of {items} points"),
    ("align/vgicp", 120000, "VGICP alignment, with its assessment"),
    ("align/ndt", 120000, "NDT alignment, 7 neighbours"),
    ("sweep/odometry", 120000, "a whole sweep of {size} raw points, odometry"),
    ("pipeline/vgicp", 120000, "two raw sweeps to their relative pose"),
    ("batch/vgicp", 64, "64 pairs of submaps of {points} points, VGICP"),
    ("batch/d2d", 64, "the same, NDT to NDT"),
]


def device(setting):
    return setting["device"] + (f", {setting['threads']} threads" if setting["software"] else "")


def median(row):
    return (row["device_ms"] or row["host_ms"])["median"]


def cell(report, name, size):
    rows = {(row["name"], row["size"]): row for row in report["rows"] if not row["problem"]}
    row = rows.get((name, size))
    if row is None:
        return "-"
    ms = median(row)
    text = f"{ms:.3g} ms" if ms < 1000 else f"{ms / 1000:.3g} s"
    peer = rows.get((row["peer"], size))
    if peer is not None:
        text += f" ({ms / median(peer):.2g} x {row['peer']})"
    return text


def label(reports, name, size, text):
    for row in (row for report in reports for row in report["rows"]):
        if (row["name"], row["size"]) == (name, size):
            points = int(row["figures"].get("points a pair", 0))
            return text.format(size=f"{size:,}".replace(",", " "), items=row["items"], points=points)
    return text


def main():
    files = [json.loads(path.read_text()) for path in sorted(HERE.glob("*.json"))]
    reports = [file for file in files if "setting" in file]  # and not what compilers say
    if not reports:
        sys.exit("table.py: there is no result beside it")
    lines = ["| | " + " | ".join(device(r["setting"]) for r in reports) + " |",
             "|---" * (len(reports) + 1) + "|"]
    for name, size, text in ROWS:
        cells = [cell(report, name, size) for report in reports]
        lines.append(f"| {label(reports, name, size, text)} | " + " | ".join(cells) + " |")
    table = "\n".join(lines) + "\n"
    print(table, end="")
    if "--write" in sys.argv[1:]:
        readme = README.read_text()
        begin = readme.index(BEGIN) + len(BEGIN)
        README.write_text(readme[:begin] + table + readme[readme.index(END):])


if __name__ == "__main__":
    main()
