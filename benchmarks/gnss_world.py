#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""How far maps that GNSS places lie from where they are in the world, beside the best that their fixes allow.

Usage: gnss_world.py --adit ADIT -o DIR [--seeds 601 602 603] [--kinds rtk single overconfident] [--jobs 3] [--quick].
Drives some 2 km through the simulated city with each receiver, maps them, and prints tables; DIR/gnss_world.json has
the same and more. What is there already is not made again. `--only simulate`, `run` and `table` do one step of the
three: the last needs DIR/results alone, which is small, and is the only one that needs numpy.

- The bound: the true trajectory, turned (yaw) and moved as fits the very same fixes best (generalised least squares of
  the true antenna positions, with the receiver's true covariance: nine tenths correlated over 60 s; outliers, which
  the truth names, left out). Its level stays true, as an IMU holds that of a map ("free" in the JSON: not so). One
  draw can lie near zero by luck, in height above all, where it is one number: "expct" is the root mean square over all
  draws, and the ratios of "all" are those of root mean squares over the seeds.
- Kinds: in the simulator fixes of all kinds err by one common drift, times the deviation of their kind. Who knows that
  reads a fixed fix's error off a float one beside it, and so does the bound: down to 1 mm where 12 mm are correlated.
  "kinds" is the same fit with nothing in common between kinds, the best without that knowledge; "/kinds" the ratio.
- Sky: of sweeps where at least 70 % of it is open, by the truth. Their true fixes have 12 mm, and twice that upwards.
- chi2: of the errors of the recording's fixes by the covariance that the bound takes, a number; 1 where that is true.
- Variants of the same recording: `without` any fixes (once a seed), the antenna taken to be the lidar's own place
  (`lever`, --set gnss.antenna), and an `outage` of 300 m from half way on, where a copy of the recording says that
  there is no fix.
- A wrong yaw at start has no variant: no setting states one, the map's place is looked for among all. Each seed begins
  elsewhere on the route, heading elsewhere: the table has the heading that was estimated and how wrong it was.
- The simulated world is flat: in the plane that touches the Earth at its origin. A levelled map bends with the Earth,
  which no rigid motion can follow: "bend" in the JSON is what that leaves of heights (rms), 2 cm 500 m away.

Exit codes: 0 done, 1 a step failed on a recording (the others are done all the same), 2 usage.
"""

import argparse
import concurrent.futures
import csv
import itertools
import json
import math
import pathlib
import shutil
import sqlite3
import struct
import subprocess
import sys
import zlib

try:
    import numpy as np
except ImportError:  # tables need it alone
    np = None

ORIGIN = (48.0, 11.0, 500.0)  # of the simulator's worlds: degrees, m
SIGMA_M = {0: 1.5, 1: 0.25, 2: 0.012}  # level, by the status of a fix; upwards twice that
CORRELATED, CORRELATION_S = 0.9, 60.0
OPEN_SKY, OUTAGE_M, ROUTE_M = 0.7, 300.0, 9000
VARIANTS = ("gnss", "without", "lever", "outage")
LIMITS = {"ratio": 1.2, "sky_m": 0.05, "nees": (0.3, 3.0), "ate": 1.1}
CHUNK, MESSAGE, CHANNEL = 6, 5, 4  # records of MCAP


def records(data, at):
    """(opcode, start) of the contents of MCAP's records."""
    while at < len(data):
        yield data[at], at + 9
        at += 9 + struct.unpack_from("<Q", data, at + 1)[0]


def fix_places(recording):
    """(start of its chunk's content, that, offsets in it of the message and of its status) of each NavSatFix."""
    topic = None
    with recording.open("rb") as stream:
        stream.seek(8)
        while len(head := stream.read(9)) == 9:
            size = struct.unpack_from("<Q", head, 1)[0]
            start = stream.tell()
            if head[0] == CHANNEL:
                channel = stream.read(size)
                if channel[4:13] == b"\x05\0\0\0/gnss":
                    topic = channel[:2]
            elif head[0] != CHUNK:
                stream.seek(size, 1)
            else:
                chunk = bytearray(stream.read(size))
                if chunk[28:32] != bytes(4):
                    raise ValueError(f"{recording}: its chunks are compressed")
                for opcode, at in records(chunk, 40):
                    if opcode == MESSAGE and chunk[at : at + 2] == topic:
                        body = at + 22 + 4
                        yield start, chunk, body, body + 12 + struct.unpack_from("<I", chunk, body + 8)[0]


def read_fix(chunk, body, status):
    """Stamp (s since the Epoch, ns), status, and offset of latitude, longitude and altitude."""
    seconds, nanoseconds = struct.unpack_from("<iI", chunk, body)
    after = status + 1 + (status + 1 - body) % 2 + 2  # the service, two bytes
    numbers = after + (body - after) % 8
    return f"{seconds}.{nanoseconds:09}", struct.unpack_from("<b", chunk, status)[0], numbers


def write_fixes(recording, file):
    with file.open("w", newline="") as out:
        rows = csv.writer(out)
        rows.writerow(["t_s", "status", "latitude", "longitude", "altitude"])
        for _, chunk, body, status in fix_places(recording):
            stamp, kind, numbers = read_fix(chunk, body, status)
            rows.writerow([stamp, kind, *map(repr, struct.unpack_from("<3d", chunk, numbers))])


def cut_fixes(recording, begin, end):
    """Says in place, from begin to end (s), that there is no fix."""
    changed = {}
    for start, chunk, body, status in fix_places(recording):
        stamp, _, numbers = read_fix(chunk, body, status)
        if begin <= float(stamp) <= end:
            struct.pack_into("<b", chunk, status, -1)
            struct.pack_into("<3d", chunk, numbers, math.nan, math.nan, math.nan)
            changed[start] = chunk
    with recording.open("r+b") as stream:
        for start, chunk in changed.items():
            struct.pack_into("<I", chunk, 24, zlib.crc32(memoryview(chunk)[40:]))
            stream.seek(start)
            stream.write(chunk)


def read_table(file):
    with file.open(newline="") as stream:
        return list(csv.DictReader(stream))


def outage_of(antenna):
    """Begin and end (s) of the outage, from half the path on: what there is of its metres."""
    places = [[float(row[axis]) for axis in ("x_m", "y_m", "z_m")] for row in antenna]
    ways = list(itertools.accumulate(map(math.dist, places, places[1:]), initial=0.0))
    inside = [float(row["t_s"]) for row, at in zip(antenna, ways) if 0 <= at - ways[-1] / 2 <= OUTAGE_M]
    return inside[0], inside[-1]


def call(words, log):
    """The output of a program, which goes to the log, too."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    with log.open("a") as stream:
        stream.write(f"$ {' '.join(map(str, words))}\n{done.stderr}\n")
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words[:3]))}: exit code {done.returncode}, see {log}")
    return done.stdout


class Recording:
    def __init__(self, options, kind, seed):
        self.options, self.kind, self.seed = options, kind, seed
        self.name = f"{kind}-{seed}-{options.duration:g}s"
        self.file = options.output / "recordings" / f"{self.name}.mcap"
        self.results = options.output / "results" / self.name
        self.log = self.results / "log.txt"

    def beside(self, end):
        return self.file.with_name(f"{self.name}.{end}")

    def simulate(self):
        if self.log.exists() and (self.results / "truth.csv").exists() and (self.file.exists() or self.is_run()):
            return
        self.file.parent.mkdir(parents=True, exist_ok=True)
        self.results.mkdir(parents=True, exist_ok=True)
        call([self.options.adit, "simulate", "city", "--trajectory", "drive", "--duration", self.options.duration,
              "--seed", self.seed, "--begin", 1300 * self.seed % ROUTE_M, "--gnss", self.kind, "--quiet",
              "-o", self.file], self.log)
        shutil.copy(self.beside("truth.antenna.csv"), self.results / "antenna.csv")
        write_fixes(self.file, self.results / "fixes.csv")
        with self.beside("truth.tum").open() as truth, (self.results / "truth.csv").open("w") as out:
            out.write("t_s,x_m,y_m,z_m\n")
            for i, line in enumerate(truth):
                if i % 4 == 0:  # 50 Hz: between these, straight lines are right to a fifth of a millimetre
                    out.write(",".join(line.split()[:4]) + "\n")

    def variants(self):
        first = self.options.kinds[0]
        return [one for one in self.options.variants if one != "without" or self.kind == first]

    def is_run(self):
        return all((self.results / one / "evaluate.json").exists() for one in self.variants())

    def run(self):
        for variant in self.variants():
            into = self.results / variant
            if (into / "evaluate.json").exists():
                continue
            into.mkdir(exist_ok=True)
            source = self.file
            own = {"without": ["gnss.use=false"], "lever": ["gnss.antenna=[0,0,0]"]}.get(variant, [])
            settings = ["mapping.enabled=true", "mapping.loops=true", *self.options.set, *own]
            words = [word for one in settings for word in ("--set", one)]
            if variant == "outage":
                source = self.beside("outage.mcap")
                shutil.copy(self.file, source)
                cut_fixes(source, *outage_of(read_table(self.results / "antenna.csv")))
            out = self.options.output / "runs" / self.name / variant
            call([self.options.adit, "run", source, "-o", out, "--quiet", "--no-map", *words], self.log)
            shutil.copy(out / "summary.json", into / "summary.json")
            self.judge(out, into, variant)
            if variant == "outage":
                source.unlink()
            if self.options.discard:
                shutil.rmtree(out)
        if self.options.discard:
            for file in self.file.parent.glob(f"{self.name}.*"):
                file.unlink()

    def judge(self, out, into, variant):
        evaluate = [self.options.adit, "evaluate", out, self.beside("truth.tum"), "--json"]
        has_place = json.loads((into / "summary.json").read_text())["map"].get("gnss", {}).get("georeference")
        if variant != "without" and isinstance(has_place, dict) and "heading_deg" in has_place:
            evaluate += ["--world", *ORIGIN]
            call([self.options.adit, "export", out / "map.adit", "--trajectory", "csv", "-o", into / "path.csv"],
                 self.log)
            with sqlite3.connect(f"file:{out / 'map.adit'}?mode=ro", uri=True) as base:
                rows = base.execute("SELECT stamp_ns, verdict FROM fixes ORDER BY stamp_ns").fetchall()
            text = "".join(f"{stamp // 10**9}.{stamp % 10**9:09},{verdict}\n" for stamp, verdict in rows)
            (into / "verdicts.csv").write_text("t_s,verdict\n" + text)
        (into / "evaluate.json").write_text(call(evaluate, self.log))


def east_north_up(places):
    """Of latitude, longitude (degrees) and altitude (m): in the plane that touches the Earth at the origin."""
    def on_earth(place):
        lat, lon = np.radians(place[..., 0]), np.radians(place[..., 1])
        flattening = 1 / 298.257223563
        e2 = flattening * (2 - flattening)
        n = 6378137.0 / np.sqrt(1 - e2 * np.sin(lat) ** 2)
        level = (n + place[..., 2]) * np.cos(lat)
        return np.stack([level * np.cos(lon), level * np.sin(lon), (n * (1 - e2) + place[..., 2]) * np.sin(lat)], -1)

    (sin_lat, sin_lon), (cos_lat, cos_lon) = np.sin(np.radians(ORIGIN[:2])), np.cos(np.radians(ORIGIN[:2]))
    axes = np.array([[-sin_lon, cos_lon, 0], [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
                     [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat]])
    return (on_earth(np.asarray(places, float)) - on_earth(np.array(ORIGIN))) @ axes.T


def noise_root(times, sigmas, is_common=True):
    """Lower triangle whose square is the covariance of the level errors of fixes; upwards they are twice that."""
    correlation = CORRELATED * np.exp(-np.abs(times[:, None] - times[None]) / CORRELATION_S)
    correlation[np.diag_indices(len(times))] = 1.0
    if not is_common:
        correlation = np.where(sigmas[:, None] == sigmas[None], correlation, 0.0)
    return np.linalg.cholesky(sigmas[:, None] * correlation * sigmas[None])


class Fit:
    """The motion of true positions that fits fixes of them best; `whiten` is the inverse of noise_root()."""

    def __init__(self, true, measured, whiten, axes):
        self.axes, self.centre, scale = axes, true.mean(0), np.array([1.0, 1.0, 0.5])
        self.R, self.t = np.eye(3), np.zeros(3)
        for _ in range(20):
            turned = (true - self.centre) @ self.R.T
            rows = np.tensordot(whiten, self.jacobian(turned), 1) * scale[:, None]
            residual = ((whiten @ (measured - self.centre - turned - self.t)) * scale).ravel()
            rows = rows.reshape(len(residual), -1)
            self.covariance = np.linalg.inv(rows.T @ rows)
            step = self.covariance @ (rows.T @ residual)
            self.R = rotation(sum(angle * np.eye(3)[axis] for angle, axis in zip(step, axes))) @ self.R
            self.t = self.t + step[len(axes) :]
            if np.abs(step).max() < 1e-8:
                break
        self.sigma_yaw = math.sqrt(self.covariance[axes.index(2), axes.index(2)])

    def jacobian(self, turned):
        turns = [np.cross(np.eye(3)[axis], turned) for axis in self.axes]
        return np.stack([*turns, *np.broadcast_to(np.eye(3)[:, None], (3, *turned.shape))], -1)

    def errors(self, points):
        """Of true points (m) that were moved so."""
        return (points - self.centre) @ self.R.T + self.t + self.centre - points

    def expected(self, points):
        """Root mean squares over all fixes that there could have been: level, upwards."""
        jacobian = self.jacobian(points - self.centre)
        variances = np.einsum("pak,kl,pal->pa", jacobian, self.covariance, jacobian).mean(0)
        return [math.sqrt(variances[:2].sum()), math.sqrt(variances[2])]


def rotation(vector):
    angle = np.linalg.norm(vector)
    K = np.cross(np.eye(3), vector / max(angle, 1e-300))
    return np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * K @ K


def rms(errors):
    """Level and upwards; nothing where there is none."""
    if len(errors) == 0:
        return [None, None]
    return [float(np.sqrt((errors[:, :2] ** 2).sum(1).mean())), float(np.sqrt((errors[:, 2] ** 2).mean()))]


def numbers(file, names):
    return np.array([[float(row[name]) for name in names] for row in read_table(file)]).reshape(-1, len(names))


def row_of(results, variant, without):
    """What one run shows."""
    folder = results / variant
    evaluated = json.loads((folder / "evaluate.json").read_text())
    gnss = json.loads((folder / "summary.json").read_text())["map"].get("gnss", {})
    antenna = numbers(results / "antenna.csv", ["t_s", "x_m", "y_m", "z_m", "open_sky", "outlier"])
    fixes = numbers(results / "fixes.csv", ["t_s", "status", "latitude", "longitude", "altitude"])
    truth = numbers(results / "truth.csv", ["t_s", "x_m", "y_m", "z_m"])
    is_cut = np.zeros(len(fixes), bool)
    begin, end = outage_of(read_table(results / "antenna.csv"))
    if variant == "outage":
        is_cut = (fixes[:, 0] >= begin) & (fixes[:, 0] <= end)
    of = np.abs(antenna[None, :, 0] - fixes[:, :1]).argmin(1)
    taken = (fixes[:, 1] >= 0) & ~is_cut & (antenna[of, 5] == 0)
    used, true = fixes[taken], antenna[of[taken], 1:4]
    sigmas = np.array([SIGMA_M[int(status)] for status in used[:, 1]])
    measured, whiten = east_north_up(used[:, 2:]), np.linalg.inv(noise_root(used[:, 0], sigmas))
    whitened = whiten @ (measured - true) * [1, 1, 0.5]
    row = {"path_m": evaluated["association"]["truth_path_m"], "fixes": int((fixes[:, 1] >= 0).sum()),
           "fixes_cut": int((is_cut & (fixes[:, 1] >= 0)).sum()), "fixes_used": gnss.get("verdicts", {}).get("used"),
           "true_outliers": int(((fixes[:, 1] >= 0) & ~is_cut & (antenna[of, 5] == 1)).sum()),
           "chi2": float((whitened**2).mean()), "ate_m": evaluated["ate"]["position_m"]["rmse"],
           "ate_without_m": without, "gnss": gnss, "world": evaluated.get("world")}
    if "world" not in evaluated:
        return row
    path = numbers(folder / "path.csv", ["stamp", "latitude_deg", "longitude_deg", "altitude_m"])
    at = np.stack([np.interp(path[:, 0], truth[:, 0], truth[:, axis]) for axis in (1, 2, 3)], -1)
    errors = east_north_up(path[:, 1:]) - at
    sky = np.interp(path[:, 0], antenna[:, 0], antenna[:, 4])
    parts = {"whole": np.ones(len(path), bool), "sky": sky >= OPEN_SKY,
             "outage": (path[:, 0] >= begin) & (path[:, 0] <= end)}
    fits = {"bound": Fit(true, measured, whiten, [2]), "free": Fit(true, measured, whiten, [0, 1, 2]),
            "kinds": Fit(true, measured, np.linalg.inv(noise_root(used[:, 0], sigmas, False)), [2])}
    for name, chosen in parts.items():
        row[name] = {"sweeps": int(chosen.sum()), "error_m": rms(errors[chosen]),
                     "largest_m": [float(abs(x).max(initial=0)) for x in
                                   (np.linalg.norm(errors[chosen, :2], axis=1), errors[chosen, 2])],
                     **{f"{kind}_m": rms(fit.errors(at[chosen])) for kind, fit in fits.items()},
                     **{f"{kind}_expected_m": fit.expected(at[chosen]) if chosen.any() else [None, None]
                        for kind, fit in fits.items() if kind != "kinds"}}
    row["whole"]["error_m"] = [row["world"]["horizontal_rmse_m"], row["world"]["vertical_rmse_m"]]
    row["evaluates_differ_m"] = float(np.abs(np.subtract(row["whole"]["error_m"], rms(errors))).max())
    from_mean, about = at[:, :2] - at[:, :2].mean(0), errors[:, :2] - errors[:, :2].mean(0)
    cross = from_mean[:, 0] * about[:, 1] - from_mean[:, 1] * about[:, 0]
    row["yaw_error_deg"] = math.degrees(cross.sum() / (from_mean**2).sum())
    row["bound_yaw_sigma_deg"] = math.degrees(fits["bound"].sigma_yaw)
    flat = np.column_stack([np.ones(len(at)), at[:, :2]])
    drop = (at[:, :2] ** 2).sum(1) / (2 * 6378137.0)
    row["bend_m"] = float(np.sqrt(((drop - flat @ np.linalg.lstsq(flat, drop, rcond=None)[0]) ** 2).mean()))
    verdicts = read_table(folder / "verdicts.csv")
    bad = {f"{t:.3f}" for t in fixes[(antenna[of, 5] == 1) & (fixes[:, 1] >= 0), 0]}
    row["true_outliers_used"] = sum(one["verdict"] == "1" and f"{float(one['t_s']):.3f}" in bad for one in verdicts)
    return row


def marked(value, digits, is_good, width):
    text = "-" if value is None else f"{value:.{digits}f}" + ("" if is_good(value) else "!")
    return f"{text:>{width}}"


def pooled(rows, key, axis, part="whole"):
    squares = [row[part][key][axis] ** 2 for row in rows if row.get(part, {}).get(key, [None, None])[axis] is not None]
    return math.sqrt(sum(squares) / len(squares)) if squares else None


def plain(value, digits, width):
    return marked(value, digits, lambda _: True, width)


def errors_and_bounds(rows, part="whole"):
    """Level, then upwards: error, bound, what it is expected to be, ratio; the same of the fit apart by kinds."""
    text = ""
    for axis in (0, 1):
        error, bound, expected, kinds = (pooled(rows, key, axis, part) for key in
                                         ("error_m", "bound_m", "bound_expected_m", "kinds_m"))
        text += plain(error, 3, 8)
        for of, also in ((bound, plain(expected, 3, 7)), (kinds, "")):
            ratio = error / of if error is not None and of else None
            text += plain(of, 3, 7) + also + marked(ratio, 2, lambda x: x <= LIMITS["ratio"], 9)
    return text


def print_tables(table, kinds, variants):
    heads = f"{'error':>8}{'bound':>7}{'expct':>7}{'ratio':>9}{'kinds':>7}{'/kinds':>9}"
    low, high = LIMITS["nees"]
    print(f"World error (m, rmse, not aligned), level and upwards; ! misses a limit: ratio {LIMITS['ratio']}, "
          f"sky {LIMITS['sky_m']} m (rtk), NEES {low} to {high}, ATE {LIMITS['ate']} times that without GNSS\n")
    print(f"{'kind':14}{'seed':>5}{'path':>6}{'used/all':>11}{'chi2':>6}{heads}{heads}"
          f"{'sky':>7}{'sky up':>8}{'NEES':>7}{'ATE':>8}{'without':>8}{'heading':>9}{'wrong by':>10}")
    for kind in kinds:
        of_kind = {seed: row for (one, seed, variant), row in table.items() if (one, variant) == (kind, "gnss")}
        for seed, row in of_kind.items():
            sky = row.get("sky", {}).get("error_m", [None, None])
            least = LIMITS["sky_m"] if kind == "rtk" else math.inf
            without = row["ate_without_m"]
            print(f"{kind:14}{seed:5}{row['path_m']:6.0f}{str(row['fixes_used']) + '/' + str(row['fixes']):>11}"
                  f"{row['chi2']:6.2f}{errors_and_bounds([row])}"
                  f"{marked(sky[0], 3, lambda x, w=least: x <= w, 7)}{marked(sky[1], 3, lambda x, w=least: x <= w, 8)}"
                  f"{marked((row['world'] or {}).get('nees'), 2, lambda x: low <= x <= high, 7)}"
                  f"{marked(row['ate_m'], 3, lambda x, w=without: w is None or x <= LIMITS['ate'] * w, 8)}"
                  f"{plain(without, 3, 8)}{plain((row['gnss'].get('georeference') or {}).get('heading_deg'), 1, 9)}"
                  f"{plain(row.get('yaw_error_deg'), 4, 10)}")
        if len(of_kind) > 1:
            print(f"{kind:14}{'all':>5}{'':6}{'':11}{'':6}{errors_and_bounds(of_kind.values())}")
    for variant, title, part in (("lever", "antenna taken to be at the lidar", "whole"),
                                 ("outage", f"along {OUTAGE_M:.0f} m without fixes", "outage")):
        if variant not in variants or not any(one == variant for _, _, one in table):
            continue
        print(f"\n{variant}: {title}; beside it the same place with all as it is\n")
        print(f"{'kind':14}{'seed':>5}{'cut':>6}{heads}{heads}{'most':>8}{'most up':>9}"
              f"{'as it is':>10}{'upwards':>9}{'ATE':>8}")
        for (kind, seed, one), row in table.items():
            if one == variant:
                most = row.get(part, {}).get("largest_m", [None, None])
                usual = table.get((kind, seed, "gnss"), {}).get(part, {}).get("error_m", [None, None])
                print(f"{kind:14}{seed:5}{row['fixes_cut']:6}{errors_and_bounds([row], part)}{plain(most[0], 3, 8)}"
                      f"{plain(most[1], 3, 9)}{plain(usual[0], 3, 10)}{plain(usual[1], 3, 9)}"
                      f"{plain(row['ate_m'], 3, 8)}")


def make_table(options, recordings):
    table = {}
    for recording in recordings:
        first = Recording(options, options.kinds[0], recording.seed).results / "without" / "evaluate.json"
        without = json.loads(first.read_text())["ate"]["position_m"]["rmse"] if first.exists() else None
        for variant in options.variants:
            if variant != "without" and (recording.results / variant / "evaluate.json").exists():
                table[recording.kind, recording.seed, variant] = row_of(recording.results, variant, without)
    print_tables(table, options.kinds, options.variants)
    rows = [{"kind": kind, "seed": seed, "variant": variant, **row} for (kind, seed, variant), row in table.items()]
    (options.output / "gnss_world.json").write_text(json.dumps({"limits": LIMITS, "rows": rows}, indent=1) + "\n")


def self_check():
    """Draws fixes of a known path by a known covariance: squares of the fit's errors are as predicted."""
    random = np.random.default_rng(1)
    times = np.arange(300) * 0.8
    true = np.stack([400 + 250 * np.sin(times / 60), 80 + 2.0 * times, 1.6 + np.sin(times / 30)], -1)
    sigmas = np.array(list(SIGMA_M.values()))[random.integers(0, 2, len(times))]
    root = noise_root(times, sigmas)
    whiten, alone = np.linalg.inv(root), np.diag(1 / sigmas)
    is_good = True
    for name, axes in (("level kept", [2]), ("level free", [0, 1, 2])):
        squares, others = [], []
        for _ in range(600):
            noise = (root @ random.normal(size=true.shape)) * [1, 1, 2]
            squares.append(np.square(rms(Fit(true, true + noise, whiten, axes).errors(true))))
            others.append(np.square(rms(Fit(true, true + noise, alone, axes).errors(true))))
        expected = Fit(true, true, whiten, axes).expected(true)
        got, other = np.sqrt(np.mean(squares, 0)), np.sqrt(np.mean(others, 0))
        is_good &= bool(np.all(np.abs(got / expected - 1) < 0.1) and np.all(other > 0.98 * got))
        print(f"{name}: level {got[0]:.4f} m, predicted {expected[0]:.4f}, without correlation {other[0]:.4f}; "
              f"upwards {got[1]:.4f} m, predicted {expected[1]:.4f}, without correlation {other[1]:.4f}")
    turned = true @ rotation(np.array([0, 0, 1.0])).T + [3, -4, 5]
    is_good &= bool(np.abs(Fit(true, turned, whiten, [2]).errors(true) - (turned - true)).max() < 1e-6)
    print("as it should be" if is_good else "WRONG")
    return 0 if is_good else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--adit", default="adit", help="the program")
    parser.add_argument("-o", "--out", dest="output", type=pathlib.Path, default=pathlib.Path("gnss-world"))
    parser.add_argument("--seeds", type=int, nargs="+", default=[601, 602, 603])
    parser.add_argument("--kinds", nargs="+", default=["rtk", "single", "overconfident"])
    parser.add_argument("--variants", nargs="+", choices=VARIANTS, default=list(VARIANTS))
    parser.add_argument("--duration", type=float, default=240.0, help="of a drive, s")
    parser.add_argument("--quick", action="store_true", help="one seed of 60 s (500 m)")
    parser.add_argument("--jobs", type=int, default=1, help="recordings at the same time")
    steps = ["simulate", "run", "table"]
    parser.add_argument("--only", nargs="+", choices=steps, default=steps, help="what is done")
    parser.add_argument("--set", action="append", default=[], metavar="SECTION.KEY=VALUE", help="for adit run")
    parser.add_argument("--discard", action="store_true", help="remove recordings (1.4 GB each) and maps once judged")
    parser.add_argument("--self-check", action="store_true", help="check the bound by draws, and nothing else")
    options = parser.parse_args()
    if np is None and (options.self_check or "table" in options.only):
        parser.error("tables need numpy: pip install numpy, or --only simulate run")
    if options.self_check:
        return self_check()
    if options.quick:
        options.seeds, options.duration = options.seeds[:1], min(60.0, options.duration)
    recordings = [Recording(options, kind, seed) for kind in options.kinds for seed in options.seeds]

    def make(recording):
        try:
            for step in ("simulate", "run"):
                if step in options.only:
                    getattr(recording, step)()
        except (RuntimeError, OSError, ValueError, KeyError) as error:
            print(f"gnss_world.py: {recording.name}: {error}", file=sys.stderr)
            return False
        return True

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(make, recordings))
    if "table" in options.only:
        make_table(options, recordings)
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
