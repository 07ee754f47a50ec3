#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Do the tests notice? Changes one constant or sign of slam/ at a time, in a copy of the tree, and runs its tests.

    tests/mutants.py                 all mutants of the list below
    tests/mutants.py --only 3 7      some of them
    tests/mutants.py --drawn 20 --seed 5
                                     numbers and signs drawn from all of slam/ instead: some of those change nothing
                                     that matters (a tolerance, a cache), so that not all can be noticed

Prints one line a mutant and how many were noticed; exits with 1 where more than two of the list were not. The copy and
its build stay in build/mutants, so that a second run compiles one file a mutant.
"""

import argparse
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
COPY = ROOT / "build" / "mutants"
# Suites that want a device come last: what the host's own tests notice is told in a second.
PROGRAMS = {"slam_tests": "-SoftwareDrivers.*:RecordedDriveTest.*", "mapping_tests": "*"}

# (file, what stands there, what is put there): each a mistake that somebody could make.
MUTANTS = [
    ("slam/core/lie.cpp", "return 1.0 / 6.0 -", "return 1.0 / 6.0 +"),
    ("slam/core/nav_state.cpp", "to.bias.gyro - from.bias.gyro", "from.bias.gyro - to.bias.gyro"),
    ("slam/inertial/preintegration.cpp", "0.5 * dt * dt * (middle * accel)", "dt * dt * (middle * accel)"),
    ("slam/inertial/preintegration.cpp", "rotation_by_gyro - 0.5 * dt * half_jacobian", "rotation_by_gyro - dt * half_jacobian"),
    ("slam/inertial/imu_buffer.cpp", "a.angular_velocity + s *", "a.angular_velocity - s *"),
    ("slam/inertial/gyroscope_integral.cpp", "rates_.back() / 3.0", "rates_.back() / 6.0"),
    ("slam/inertial/reading_gate.cpp", "kBeyondUsual = 6.0", "kBeyondUsual = 60.0"),
    ("slam/inertial/imu_start_at_rest.cpp", "(norm - kStandardGravity) * start.up_body", "(kStandardGravity - norm) * start.up_body"),
    ("slam/inertial/saturation.cpp", "kRepeats = 3", "kRepeats = 6"),
    ("slam/fusion/imu_factor.cpp", "t * from.v_map_body - 0.5 * t * t * gravity", "t * from.v_map_body + 0.5 * t * t * gravity"),
    ("slam/fusion/imu_factor.cpp", "(kVelocity, kVelocityAt) = -R_body_map", "(kVelocity, kVelocityAt) = R_body_map"),
    ("slam/fusion/walk_factor.cpp", "-skew(unit) * across(unit)", "skew(unit) * across(unit)"),
    ("slam/fusion/state_chain.cpp", "state.cost + link.cost - 0.5 *", "state.cost + link.cost + 0.5 *"),
    ("slam/fusion/state_prior.cpp", "prior.root * moved + prior.offset", "prior.root * moved - prior.offset"),
    ("slam/fusion/convergence.cpp", "kSmallDecrease = 1e-9", "kSmallDecrease = 1e-1"),
    ("slam/fusion/high_rate.cpp", "kVelocityAt) = t * back", "kVelocityAt) = -t * back"),
    ("slam/odometry/motion_model.cpp", "kLongestExtrapolation = 1.0", "kLongestExtrapolation = 3.0"),
    ("slam/odometry/pose_uncertainty.cpp", "moved(from.uncertainty.local, T_from_to) -", "moved(from.uncertainty.local, T_from_to) +"),
    ("slam/submaps/ground_plane.cpp", "fit.plane.offset = -fit.plane.normal.dot(mean)", "fit.plane.offset = fit.plane.normal.dot(mean)"),
    ("slam/executor/sensor_feed.cpp", "kLongestWait = std::chrono::milliseconds(300)", "kLongestWait = std::chrono::milliseconds(3000)"),
]


def tracked_files():
    told = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, check=True, capture_output=True, text=True)
    return [line for line in told.stdout.splitlines() if (ROOT / line).is_file()]


def refresh(relative):
    """The copy's file as the tree has it; its time changes only where its text does."""
    source, target = ROOT / relative, COPY / "tree" / relative
    if not target.exists() or target.read_bytes() != source.read_bytes():
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)


def prepare():
    wanted = tracked_files()
    for relative in wanted:
        refresh(relative)
    for path in (COPY / "tree").rglob("*"):
        if path.is_file() and str(path.relative_to(COPY / "tree")) not in wanted:
            path.unlink()
    shared = COPY / "shared"  # where the tests look for recorded data
    if not shared.exists() and (ROOT.parent / "shared").exists():
        shared.symlink_to(ROOT.parent / "shared")
    build = COPY / "build"
    if not (build / "build.ninja").exists():
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DADIT_TESTS=ON", "-DADIT_BENCHMARKS=OFF"]
        if shutil.which("ccache"):
            options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
        subprocess.run(["cmake", "-S", COPY / "tree", "-B", build, "-G", "Ninja", *options], check=True, stdout=subprocess.DEVNULL)


def compiles():
    return subprocess.run(["cmake", "--build", COPY / "build", "--target", *PROGRAMS], stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL).returncode == 0


def host_suites(program):
    """The suites of a program that want no device, as a filter, and the rest as another."""
    listed = subprocess.run([COPY / "build" / "tests" / program, "--gtest_list_tests"], capture_output=True, text=True).stdout
    suites = re.findall(r"^(\w[\w/]*)\.", listed, re.M)
    device = [s for s in suites if re.search(r"Test$|CompetingPoses|Batch|HighRateOfADrive|Software|Recorded|SlamFacade|DamagedReadings", s)]
    return ":".join(f"{s}.*" for s in suites if s not in device), ":".join(f"{s}.*" for s in device)


def noticed_by():
    """The first test that fails; none where all pass."""
    for part in (0, 1):
        for program, chosen in PROGRAMS.items():
            suites = host_suites(program)[part]
            if not suites:
                continue
            left_out = chosen[1:] if chosen.startswith("-") else ""
            filter_ = f"{suites}-{left_out}" if left_out else suites
            try:
                ran = subprocess.run([COPY / "build" / "tests" / program, f"--gtest_filter={filter_}", "--gtest_fail_fast"],
                                     capture_output=True, text=True, timeout=900)
            except subprocess.TimeoutExpired:
                return f"{program} does not end"
            if ran.returncode != 0:
                failed = re.findall(r"\[  FAILED  \] ([\w/.]+)", ran.stdout)
                return failed[0] if failed else f"{program} ends with {ran.returncode}"
    return None


def drawn(count, seed):
    """Numbers that become half as large again, and signs that turn, drawn from all sources of slam/."""
    places = []
    for path in sorted((ROOT / "slam").rglob("*.cpp")):
        text = path.read_text()
        for match in re.finditer(r"(?<![\w.\"])(\d+\.\d+(?:e-?\d+)?)(?![\w.\"])| ([+-]) (?=[\w(])", text):
            line = text[text.rfind("\n", 0, match.start()) + 1:text.find("\n", match.start())]
            if not line.strip().startswith("//") and "#include" not in line and '"' not in line:
                places.append((str(path.relative_to(ROOT)), match))
    chosen = random.Random(seed).sample(places, count)
    mutants = []
    for relative, match in chosen:
        new = repr(1.5 * float(match[1]) or 1.0) if match[1] else {"+": " - ", "-": " + "}[match[2]]
        mutants.append((relative, match.span(), match[0], new))
    return mutants


def mutated(text, old, new, span=None):
    if span:
        return text[:span[0]] + new + text[span[1]:]
    if text.count(old) != 1:
        sys.exit(f"mutants.py: '{old}' stands {text.count(old)} times where once was expected: mend the list")
    return text.replace(old, new)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--only", type=int, nargs="+", metavar="N", help="numbers of the list")
    parser.add_argument("--drawn", type=int, metavar="COUNT", help="so many drawn ones instead of the list")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if arguments.drawn:
        mutants = [(f, old, new, span) for f, span, old, new in drawn(arguments.drawn, arguments.seed)]
    else:
        mutants = [(*m, None) for m in MUTANTS]
    numbers = arguments.only or range(1, len(mutants) + 1)
    for relative, old, new, span in mutants:
        mutated((ROOT / relative).read_text(), old, new, span)  # a list that is out of date says so at once
    os.environ.setdefault("VK_DRIVER_FILES", "/usr/share/vulkan/icd.d/lvp_icd.x86_64.json")
    prepare()
    if not compiles():
        sys.exit("mutants.py: the tree itself does not build")
    if failed := noticed_by():
        sys.exit(f"mutants.py: without any mutant {failed} fails")
    noticed = 0
    for number in numbers:
        relative, old, new, span = mutants[number - 1]
        begin = time.monotonic()
        target = COPY / "tree" / relative
        target.write_text(mutated((ROOT / relative).read_text(), old, new, span))
        test = noticed_by() if compiles() else "the compiler"
        refresh(relative)
        noticed += test is not None
        line = (ROOT / relative).read_text()[:span[0]].count("\n") + 1 if span else None
        place = f"{relative}:{line}" if line else relative
        print(f"{number:3}  {'noticed' if test else 'MISSED ':7}  {place}: {old.strip()} -> {new.strip()}"
              f"  ({test or 'all tests pass'}, {time.monotonic() - begin:.0f} s)", flush=True)
    print(f"{noticed} of {len(numbers)} mutants noticed")
    return 0 if arguments.drawn or noticed >= len(numbers) - 2 else 1


if __name__ == "__main__":
    sys.exit(main())
