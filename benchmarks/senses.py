#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""What further sensors are worth, and what a wrong one costs: wheels, Doppler, another odometry, headings, lidars.

Usage: senses.py --adit ADIT -o DIR [--rows ROW ...] [--seeds 1 2 3 4 5] [--only GROUP ...] [--list] [--table].
Simulates each recording, maps it with and without the sensor, compares with the truth and prints a table for each
group: median and worst of the seeds. DIR/results.jsonl keeps a line a run; what is there already is not run again.
Recordings are removed once they are judged (--keep keeps them).

- tunnel, field, moving: the mine's smooth tunnel, a bare field, and a start in motion there: without, with wheels, with
  Doppler, and with both. ATE (m, SE(3)-aligned) and verdict.
- wrong-mine, wrong-city: wheels and another odometry with each fault. The ATE over that of the same recording
  without the source; `named` says in how many runs the run's output names the fault or the source is refused.
- lidars: several range sensors merged, compared with each alone; one unplugged at half time; a pose wrong by 3 degrees.
- headings: single fixes with headings and without: yaw (degrees) at the first sweep, position in the world (m, rms),
  after 10 s and at the end.

Exit codes: 0 done, 1 a command failed (the others are done all the same), 2 usage.
"""

import argparse
import json
import math
import pathlib
import statistics
import subprocess
import sys

ORIGIN = (48.0, 11.0, 500.0)  # of the simulator's worlds: degrees, m
WHEELS = ["recording.velocity_topic=/wheels"]
CAMERA = ["recording.velocity_topic=/visual_odometry", "recording.velocity_of_poses=true"]
NO_DOPPLER = ["velocity.doppler=false"]
HEADING = ["recording.heading_topic=/heading"]
WHEEL_FAULTS = ["scale", "slip", "stuck", "units", "reversed", "axes", "late", "zero-covariance", "negative-covariance"]
# Rotations about the vertical.
MOUNTINGS = {"mounting turned by 180 degrees": "velocity.T_lidar_sensor=[-0.03,0.21,-0.58,0,0,1,0]",
             "mounting turned by 10 degrees": "velocity.T_lidar_sensor=[-0.03,0.21,-0.58,0,0,0.0871557,0.9961947]"}
HEADING_FAULTS = ["off-90", "off-180", "noisy", "stuck", "outliers"]

def scene_file(scene, lidars, duration, seed, begin):
    """A scene file; `lidars`: for each the lines of its table."""
    tables = "".join("[[lidar]]\n" + "".join(f"{line}\n" for line in lidar) for lidar in lidars)
    return (f'scene = "{scene}"\nduration = {duration}\nseed = {seed}\n'
            f'[trajectory]\nstyle = "walk"\nbegin = {begin}\n{tables}')


def lidar(name, *more, sensor="VLP-16"):
    """The lines of a range sensor's table."""
    return [f'sensor = "{sensor}"', f'topic = "/{name}"', f'frame = "{name}"', *more]


TWO_VLP16 = [lidar("front"), lidar("rear", "position = [-0.6, 0.0, 0.1]", "yaw_pitch_roll = [170.0, 30.0, 0.0]")]
ONE_ENDS = [TWO_VLP16[0], [*TWO_VLP16[1], "end = 10.0"]]
DOME = [lidar("front", sensor="Mid-360"), lidar("rear", "position = [-0.3, 0.0, 0.2]", sensor="OS0-128")]
AVIAS = [lidar("front", sensor="Avia"),
         lidar("rear", "position = [-0.2, 0.15, 0.08]", "yaw_pitch_roll = [120.0, 0.0, 0.0]", sensor="Avia"),
         lidar("right", "position = [-0.2, -0.15, 0.08]", "yaw_pitch_roll = [-120.0, 0.0, 0.0]", sensor="Avia")]


def merged(*topics):
    return ["--topic", "/front", *(word for one in topics for word in ("--merge", one))]


def alone(topic):
    return ["--topic", topic]


class Recording:
    """A recording to simulate, and the runs to make of it: name -> words for `adit run`."""

    def __init__(self, group, name, simulate, runs, scene_file=None, world=False):
        self.group, self.name, self.simulate, self.runs = group, name, simulate, runs
        self.scene_file, self.world = scene_file, world


def settings(*lists):
    return [word for one in lists for setting in one for word in ("--set", setting)]


def begin_of(seed, route):
    """Each seed begins elsewhere."""
    return 137 * seed % route


def observed(seed):
    runs = {"none": settings(NO_DOPPLER), "wheels": settings(NO_DOPPLER, WHEELS), "Doppler": [],
            "both": settings(WHEELS)}
    runs = {name: ["--odometry", *words] for name, words in runs.items()}
    more = ["--wheels", "--doppler"]
    yield Recording("tunnel", "tunnel", ["mine", "--begin", 410, "--duration", 50, *more], runs)
    yield Recording("field", "field", ["field", "--begin", begin_of(seed, 600), "--duration", 20, *more], runs)
    yield Recording("moving", "moving", ["field", "--trajectory", "moving-start", "--begin", begin_of(seed, 600),
                                         "--duration", 15, *more], runs)


def wrong(seed):
    for scene, route in (("mine", 380), ("city", 9000)):
        base = [scene, "--duration", 15, "--begin", begin_of(seed, route)]
        group = f"wrong-{scene}"
        without = {"without": ["--odometry"]}
        fused = ["--odometry", *settings(WHEELS)]
        mountings = {name: fused + ["--set", words] for name, words in MOUNTINGS.items()}
        yield Recording(group, "wheels right", [*base, "--wheels"], {**without, "wheels right": fused, **mountings})
        for fault in WHEEL_FAULTS:
            yield Recording(group, fault, [*base, "--wheels", "--fault", f"wheel-{fault}"], {f"wheels {fault}": fused})
        for fault in ("leap", "lost"):
            yield Recording(group, fault, [*base, "--visual-odometry", "--fault", f"odometry-{fault}"],
                            {f"odometry {fault}": ["--odometry", *settings(CAMERA)]})


def lidars(seed):
    each = {"front alone": alone("/front"), "rear alone": alone("/rear")}
    turned = "recording.T_lidar_further=[[-0.63,0.01,0.02,{}]]"
    half = [math.radians(angle) / 2 for angle in (173, 30)]  # yaw 3 degrees more than the simulation's 170
    yaw, pitch = (math.cos(half[0]), math.sin(half[0])), (math.cos(half[1]), math.sin(half[1]))
    quaternion = (-yaw[1] * pitch[1], yaw[0] * pitch[1], yaw[1] * pitch[0], yaw[0] * pitch[0])
    wrong_pose = ["--set", turned.format(",".join(f"{one:.6f}" for one in quaternion))]
    fill = {"duration": 20, "seed": seed, "begin": begin_of(seed, 90)}
    for scene in ("office", "mine"):
        two = scene_file(scene, TWO_VLP16, **fill)
        runs = {"merged": merged("/rear"), "3 degrees wrong": merged("/rear") + wrong_pose, **each}
        yield Recording("lidars", f"two VLP-16, {scene}", [], runs, two)
    gone = scene_file("office", ONE_ENDS, **fill)
    yield Recording("lidars", "two VLP-16, rear unplugged", [], {"merged": merged("/rear")}, gone)
    fill["duration"] = 12
    yield Recording("lidars", "Mid-360 and OS0-128", [], {"merged": merged("/rear"), **each}, scene_file("office", DOME, **fill))
    yield Recording("lidars", "three Avias", [],
                    {"merged": merged("/rear", "/right"), **each, "right alone": alone("/right")}, scene_file("office", AVIAS, **fill))


def headings(seed):
    base = ["city", "--duration", 40, "--begin", begin_of(seed, 9000), "--gnss", "single", "--heading"]
    both = {"without": [], "headings": settings(HEADING), "without, 10 s": ["--count", 100],
            "headings, 10 s": ["--count", 100, *settings(HEADING)]}
    yield Recording("headings", "right", base, both, world=True)
    for fault in HEADING_FAULTS:
        yield Recording("headings", fault, [*base, "--fault", f"heading-{fault}"],
                        {f"headings {fault}": settings(HEADING)}, world=True)


def recordings(seed):
    yield from wrong(seed)
    yield from observed(seed)
    yield from headings(seed)
    yield from lidars(seed)


def call(words, log):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    with log.open("a") as stream:
        stream.write(f"$ {' '.join(map(str, words))}\n{done.stderr}\n")
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words[:3]))}: exit code {done.returncode}, see {log}")
    return done.stdout


def read_tum(file):
    rows = (line.split() for line in file.read_text().splitlines() if not line.startswith("#"))
    return [[float(value) for value in row] for row in rows]


def yaw_of(x, y, z, w):
    """Of the x axis, rad."""
    return math.atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z))


def times(a, b):
    """Product of two quaternions, x y z w."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


def yaw_error(out, truth, georeference):
    """Of the first sweep in the world, degrees; the world of a run is turned by the convergence of meridians alone."""
    first = read_tum(out / "trajectory.tum")[0]
    nearest = min(read_tum(truth), key=lambda row: abs(row[0] - first[0]))
    error = yaw_of(*times(georeference["T_world_map"][3:], first[4:])) - yaw_of(*nearest[4:])
    return math.degrees(math.remainder(error, 2 * math.pi))


class Bench:
    def __init__(self, options):
        self.options, self.folder = options, options.output
        self.folder.mkdir(parents=True, exist_ok=True)
        self.file, self.log = self.folder / "results.jsonl", self.folder / "log.txt"
        lines = self.file.read_text().splitlines() if self.file.exists() else []
        self.results = {self.key(row): row for row in map(json.loads, lines)}

    @staticmethod
    def key(row):
        return row["group"], row["recording"], row["run"], row["seed"]

    def measure(self, recording, seed):
        wanted = {name: words for name, words in recording.runs.items()
                  if (recording.group, recording.name, name, seed) not in self.results}
        if not wanted:
            return
        file = self.folder / "recording.mcap"
        scene = recording.simulate
        if recording.scene_file:
            scene_file = self.folder / "scene.toml"
            scene_file.write_text(recording.scene_file)
            scene = [scene_file]
        more = [] if recording.scene_file else ["--seed", seed]
        call([self.options.adit, "simulate", *scene, *more, "-o", file, "--overwrite", "--quiet"], self.log)
        for name, words in wanted.items():
            row = {"group": recording.group, "recording": recording.name, "run": name, "seed": seed,
                   **self.judge(file, words, recording.world)}
            self.results[self.key(row)] = row
            with self.file.open("a") as stream:
                stream.write(json.dumps(row) + "\n")
        if not self.options.keep:
            for one in self.folder.glob("recording.*"):
                one.unlink()

    def judge(self, file, words, world):
        out, truth = self.folder / "run", file.with_name("recording.truth.tum")
        call([self.options.adit, "run", file, "-o", out, "--overwrite", "--quiet", "--no-map", *words], self.log)
        summary = json.loads((out / "summary.json").read_text())
        place = summary.get("map", {}).get("gnss", {}).get("georeference")
        placed = world and isinstance(place, dict) and "T_world_map" in place
        more = ["--world", *ORIGIN] if placed else []
        found = json.loads(call([self.options.adit, "evaluate", out / "trajectory.tum" if not placed else out, truth,
                                 "--json", *more], self.log))
        velocity = summary.get("velocity", {})
        heads = summary.get("map", {}).get("gnss", {}).get("headings", {})
        row = {"ate_m": found["ate"]["position_m"]["rmse"], "path_m": found["association"]["truth_path_m"],
               "verdict": summary["verdict"]["state"], "velocity": velocity, "headings": heads.get("state"),
               "sources": summary.get("sources")}
        if placed:
            row["world_m"] = found["world"]["horizontal_rmse_m"]
            row["yaw_deg"] = yaw_error(out, truth, place)
        return row

    def of(self, group):
        """(recording, run) -> rows, in the order of the seeds."""
        found = {}
        for key, row in self.results.items():
            if key[0] == group and key[3] in self.options.seeds:
                found.setdefault((key[1], key[2]), []).append(row)
        return found

    def print_tables(self):
        for group in dict.fromkeys(key[0] for key in self.results):
            print(f"\n{group}\n")
            if group.startswith("wrong-"):
                self.print_ratios(group)
            elif group == "headings":
                print_worlds(self.of(group))
            else:
                print("| recording | run | ATE median | worst | verdicts |\n|---|---|---|---|---|")
                for (name, run), rows in self.of(group).items():
                    ates = [row["ate_m"] for row in rows]
                    print(f"| {name} | {run} | {statistics.median(ates):.4f} | {max(ates):.4f} | {verdicts(rows)} |")

    def print_ratios(self, group):
        without = {row["seed"]: row["ate_m"] for row in self.of(group).get(("wheels right", "without"), [])}
        print(f"without: ATE {statistics.median(without.values()):.4f} m, worst {max(without.values()):.4f}\n"
              if without else "")
        print("| run | ratio median | worst | ATE worst | fused | refused | named | scale |\n|---|---|---|---|---|---|---|---|")
        for (_, run), rows in self.of(group).items():
            rows = [row for row in rows if row["seed"] in without]
            ratios = [row["ate_m"] / without[row["seed"]] for row in rows]
            sensors = [row["velocity"].get("sensor", {}) for row in rows]
            if run == "without" or not ratios:
                continue
            scales = [f"{one['scale']:.3f}" for one in sensors if one.get("fused")]
            print(f"| {run} | {statistics.median(ratios):.2f} | {max(ratios):.2f} | "
                  f"{max(row['ate_m'] for row in rows):.4f} | {sum(one.get('fused', 0) for one in sensors)} | "
                  f"{sum(one.get('refused', 0) for one in sensors)} | "
                  f"{sum(map(is_named, rows))} of {len(rows)} | {' '.join(scales)} |")


def is_named(row):
    """The run says that something is wrong with the sensor of velocities."""
    return any(one["name"] == "velocity" and one["remark"] for one in row["sources"] or []) or bool(
        row["velocity"].get("sensor", {}).get("why_refused"))


def verdicts(rows):
    names = [row["verdict"] for row in rows]
    return ", ".join(f"{names.count(name)} {name}" for name in dict.fromkeys(names))


def print_worlds(table):
    print("| run | placed | yaw median | worst | world median | worst | headings | verdicts |\n|" + "---|" * 8)
    for (_, run), rows in table.items():
        placed = [row for row in rows if "yaw_deg" in row]
        yaws, places = [abs(row["yaw_deg"]) for row in placed], [row["world_m"] for row in placed]
        numbers = (f"{statistics.median(yaws):.2f} | {max(yaws):.2f} | {statistics.median(places):.2f} | "
                   f"{max(places):.2f}" if placed else "- | - | - | -")
        states = [row["headings"] for row in rows if row["headings"]]
        said = ", ".join(f"{states.count(one)} {one}" for one in dict.fromkeys(states))
        print(f"| {run} | {len(placed)} of {len(rows)} | {numbers} | {said} | {verdicts(rows)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--adit", default="adit", help="the program")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3, 4, 5])
    groups = ["tunnel", "field", "moving", "wrong-mine", "wrong-city", "lidars", "headings"]
    parser.add_argument("--only", nargs="+", choices=groups, default=groups, help="groups")
    parser.add_argument("--rows", nargs="+", default=[], help="only recordings whose name has one of these words")
    parser.add_argument("--keep", action="store_true", help="keep the last recording")
    parser.add_argument("--table", action="store_true", help="print the tables of what was measured, and run nothing")
    options = parser.parse_args()
    bench = Bench(options)
    whole = True
    wanted = {} if options.table else {seed: list(recordings(seed)) for seed in options.seeds}
    for place in range(max(map(len, wanted.values()), default=0)):  # row by row, so that the first tables are whole
        for seed, rows in wanted.items():
            recording = rows[place]
            chosen = not options.rows or any(word in recording.name for word in options.rows)
            if recording.group not in options.only or not chosen:
                continue
            try:
                bench.measure(recording, seed)
            except (RuntimeError, OSError, ValueError, KeyError) as error:
                print(f"senses.py: {recording.group}, {recording.name}, seed {seed}: {error!r}", file=sys.stderr)
                whole = False
    bench.print_tables()
    return 0 if whole else 1


if __name__ == "__main__":
    sys.exit(main())
