#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Compares docs/formats.md and docs/schemas with what the program writes: every --json, both tables of a run, the map's tables.

Usage: formats.py ADIT. Everything that is written must be on the page, under the heading of its command, and everything
on the page must be written, but for what it calls "only" or of another command of the same heading. Each JSON must be as
the schema has it that it names. Exits 1 if not.
"""

import json
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile

import json_schema

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "formats.md"
# Heading of the page, and the commands whose JSON it describes; they run in a folder of their own.
COMMANDS = {
    "adit run: summary.json": [
        ["run", "drive.mcap", "-o", "json", "--json", "--high-rate"],
        ["run", "wheels.mcap", "-o", "wheeled", "--json", "--set", "recording.velocity_topic=/wheels"]],
    "adit inspect --json": [
        ["inspect", "drive.mcap", "--json"], ["inspect", "wheels.mcap", "--json"],
        ["inspect", "two.mcap", "--json", "--set", "recording.sweep_topic=/front", "--set",
         'recording.further_sweep_topics=["/rear"]']],
    "adit evaluate --json": [["evaluate", "json/trajectory.tum", "drive.truth.tum", "--json"]],
    "adit align --json": [["align", "drive.mcap@0", "drive.mcap@9", "--json"],
                          ["align", "drive.mcap@0", "drive.mcap@9", "--guess", "0", "0", "0", "5", "--json"]],
    "adit info, check, loops and optimize --json": [
        *[[verb, "json/map.adit", "--json"] for verb in ("info", "check", "loops", "optimize")],
        ["optimize", "json/map.adit", "--control", "points.csv", "--utm", "32N", "--json"],
        ["info", "json/map.adit", "--json"]],
    "adit merge --json": [["merge", "one", "two", "json", "-o", "merged.adit", "--json"]],
    "adit plan --json": [["plan", "fleet.toml", "-o", "plan", "--json"]],
    "adit split --json": [["split", "merged.adit", "--session", "2", "-o", "split.adit", "--json"]],
    "adit changes --json": [["changes", "merged.adit", "--json"]],
    "adit volume --json": [["volume", "merged.adit", "--json"],
                           ["volume", "one", "--above", "surroundings", "--box=-1,-1,1,1", "--json"]],
    "adit devices --json": [["devices", "--json"]],
}
SCHEMAS = PAGE.parent / "schemas"
# Other forms of these, of which the page has no table: their schemas alone.
MORE = [
    ["inspect", "json", "--json"],
    ["evaluate", "json", "--json"],
    ["evaluate", "json", "drive.truth.tum", "--json"],
    ["evaluate", "json/trajectory.tum", "json/odometry.tum", "drive.truth.tum", "--json"],
    ["devices", "--json", "--no-self-test"],
    ["align", "drive.mcap@0", "drive.mcap@9", "--min-overlap", "1", "--json"],
    ["run", "drive.mcap", "--map", "json", "-o", "there", "--json"],
]
# Written into a file. Of two systems that `bench slam` compares with, one has no trajectory.
FILES = [(words + ["bench.json"], "bench.json") for words in (
    ["bench", "deskew", "--sizes", "5000", "--seconds", "0", "--json"],
    ["bench", "deskew", "--sizes", "5000", "--seconds", "0", "--report"],
    ["bench", "slam", "--recordings", "rows", "--trajectories", "others", "-o", "slam", "--json"],
    ["bench", "slam", "--recordings", "rows", "--loops", "-o", "slam", "--json"],
    ["bench", "consistency", "--only", "room", "--runs", "1", "--duration", "2", "--json"])]
# Two sessions of the room, for `merge`.
SESSIONS = [words for name, more in (("one", []), ("two", ["--noise-seed", "6", "--reverse"])) for words in (
    ["simulate", "room", "--trajectory", "handheld", "--duration", "30", "--seed", "5", *more, "-o", f"{name}.mcap"],
    ["run", f"{name}.mcap", "-o", name])]
SIMULATE = ["simulate", "room", "--sensor", "VLP-16", "--duration", "4", "--seed", "5", "-o", "drive.mcap"]
TWO_LIDARS = """scene = "room"
duration = 2.0
[[lidar]]
topic = "/front"
frame = "front"
[[lidar]]
topic = "/rear"
frame = "rear"
position = [-0.6, 0.0, 0.1]
"""
WHEELS = ["simulate", "mine", "--wheels", "--doppler", "--duration", "4", "-o", "wheels.mcap"]


def keys(value, path=""):
    """Paths of all that is in a JSON value, lists as []."""
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from keys(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and value:
        for inner in value:
            yield from keys(inner, path + "[]")
    else:
        yield path + "[]" if isinstance(value, list) else path


def sections(text):
    """Heading: rows of its tables, as (names in the first cell, the second cell)."""
    found, heading = {}, ""
    for line in text.split("\n"):
        if line.startswith("## "):
            heading = line[3:]
        elif line.startswith("| `"):
            cells = line.strip("| ").split(" | ")
            found.setdefault(heading, []).append((re.findall(r"`([^`]+)`", cells[0]), cells[1]))
    return found


def pattern(name):
    """`*` stands for anything within a name; a last `*` and a last `[]` also for what lies below."""
    text = re.escape(name).replace(r"\*", r"[^.\[\]]*")
    return re.compile(text + (r"(\..+|\[\].*)?" if name.endswith(("*", "[]")) else ""))


def compare(heading, rows, written):
    names = [(name, text) for cell, text in rows for name in cell]
    for key in sorted(written):
        if not any(pattern(name).fullmatch(key) for name, _ in names):
            yield f"{heading}: {key} is written, and not on the page"
    for name, text in names:
        if not text.startswith(("only ", "`null`")) and not any(pattern(name).fullmatch(key) for key in written):
            yield f"{heading}: {name} is on the page, and not written"


def spread(rows):
    """Columns named "`x_m` to `qw`" are all of those between."""
    columns = ["x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"]
    return [(columns if cell == ["x_m", "qw"] else cell, text) for cell, text in rows]


def against_schema(what, value, used):
    """What the schema that the value names does not allow; `used` gets its name."""
    name = str(value.get("schema", "")).split("/", 1)[0]
    file = SCHEMAS / f"{name}.schema.json"
    if not file.exists():
        yield f"{what}: it names no schema of docs/schemas: {value.get('schema')}"
        return
    used.add(file.name)
    for problem in json_schema.problems(json.loads(file.read_text()), value):
        yield f"{what}: {file.name}: {problem}"


def check(adit, folder, page):
    def run(words):
        return subprocess.run([adit, *words], cwd=folder, capture_output=True, text=True, timeout=300)

    (pathlib.Path(folder) / "two.toml").write_text(TWO_LIDARS)
    (pathlib.Path(folder) / "fleet.toml").write_text('recordings = ["one.mcap", "two.mcap"]\n')
    for words in (SIMULATE, WHEELS, ["simulate", "two.toml", "-o", "two.mcap"], *SESSIONS):
        prepared = run(words)
        if prepared.returncode != 0:
            yield f"adit {' '.join(words)}: {prepared.stderr}"
            return
    shutil.copy(pathlib.Path(__file__).resolve().parent / "support" / "points.csv", folder)
    used = set()
    for heading, commands in COMMANDS.items():
        written = set()
        for words in commands:
            answer = run(words)
            if not answer.stdout.startswith("{"):
                yield f"adit {' '.join(words)}: no JSON: {answer.stdout}{answer.stderr}"
                continue
            written |= set(keys(json.loads(answer.stdout)))
            yield from against_schema(f"adit {' '.join(words)}", json.loads(answer.stdout), used)
        yield from compare(heading, page.get(heading, []), written)
    for words in MORE:
        answer = run(words)
        if not answer.stdout.startswith("{"):
            yield f"adit {' '.join(words)}: no JSON: {answer.stdout}{answer.stderr}"
            continue
        yield from against_schema(f"adit {' '.join(words)}", json.loads(answer.stdout), used)
    rows, others = pathlib.Path(folder, "rows"), pathlib.Path(folder, "others")
    for one in (rows, others / "absent", others / "peer"):
        one.mkdir(parents=True)
    for name in ("drive.mcap", "drive.truth.tum"):
        shutil.copy(pathlib.Path(folder, name), rows / name)
    shutil.copy(rows / "drive.truth.tum", others / "peer" / "drive.tum")
    for words, file in FILES:
        answer = run(words)
        if answer.returncode != 0:
            yield f"adit {' '.join(words)}: {answer.stdout}{answer.stderr}"
            continue
        value = json.loads((pathlib.Path(folder) / file).read_text())
        yield from against_schema(f"adit {' '.join(words)}", value, used)
    for file in sorted(SCHEMAS.glob("*.json")):
        if file.name not in used:
            yield f"{file.name}: no command writes what it describes"
    header = (pathlib.Path(folder) / "json" / "sweeps.csv").read_text().split("\n", 1)[0].split(",")
    heading = "adit run: sweeps.csv"
    yield from compare(heading, spread(page.get(heading, [])), set(header))
    header = (pathlib.Path(folder) / "there" / "localization.csv").read_text().split("\n", 1)[0].split(",")
    heading = "adit run: localization.csv"
    yield from compare(heading, page.get(heading, []), set(header))
    with sqlite3.connect(pathlib.Path(folder) / "json" / "map.adit") as database:
        tables = {name: {row[1] for row in database.execute(f"PRAGMA table_info({name})")} for (name,) in
                  database.execute("SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'places_%'")}
    for name in sorted(tables):
        if ("checksum" in tables[name]) == (name == "places"):
            yield f"The map database: {name}: every table but places has a checksum"
        tables[name].discard("checksum")
    heading = "The map database"
    described = {}
    for cell, text in page.get(heading, []):
        described[cell[0]] = set(re.findall(r"`(\w+)`", re.sub(r"\([^)]*\)", "", text)))
    described["end_candidates"] = described.get("candidates", set())
    for name in sorted(set(tables) | set(described)):
        if tables.get(name) != described.get(name):
            yield f"{heading}: {name}: columns {sorted(tables.get(name, []))}, the page has {sorted(described.get(name, []))}"


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        problems = list(check(str(pathlib.Path(sys.argv[1]).resolve()), folder, sections(PAGE.read_text())))
    print("\n".join(problems))
    print(f"formats: {len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
