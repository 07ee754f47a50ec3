#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Checks the rules of the tree that no compiler checks; docs/architecture.md gives them.

Usage: check_tree.py [--plan] [ROOT]. Prints one line a violation and exits 1 if there is any; with --plan a line a group:
its files, its lines, and the groups that it includes.
"""

import pathlib
import re
import subprocess
import sys

TOP_FOLDERS = {"shaders", "engine", "slam", "tools", "tests", "benchmarks", "docs"}
HARD_LIMIT = 500
MARKDOWN_LIMIT = 120
CODE = {".cpp", ".hpp", ".h", ".comp", ".glsl", ".py", ".sh", ".cmake", ".ts", ".mjs", ".css"}
CXX = {".cpp", ".hpp", ".h"}
GLSL = {".comp", ".glsl"}
SPDX = ("SPDX-FileCopyrightText: ", "SPDX-License-Identifier: Apache-2.0")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
MACHINE_PATH = re.compile(r"(?<![\w./}$-])/(home|root|work|mnt|Users)/")
PRINTS = re.compile(r"\bstd::(cout|cerr|clog)\b|\b(f?printf|f?puts|putchar)\s*\(|\b(std::)?(exit|abort|quick_exit)\s*\(")
LINK = re.compile(r"\]\(([^)#\s]+)(#[^)\s]*)?\)")
# Groups of files, lowest first: a file includes its own group and those above it in this list, never one below.
# Each is a CMake library of its own (the CMakeLists.txt of its top folder); engine/ and engine/vulkan/ are one.
GROUPS = [
    "shaders", "engine", "engine/kernels", "engine/self_test",
    "slam/core", "slam/inertial", "slam/registration", "slam/fusion", "slam/odometry", "slam/graph",
    "slam/submaps", "slam/coloring", "slam/gnss", "slam/loops", "slam/mapping", "slam/executor",
    "tools/support", "tools/drawing", "tools/clouds", "tools/containers", "tools/packets", "tools/recordings",
    "tools/cameras", "tools/topics", "tools/results", "tools/simulator", "tools/map_database", "tools/map_products",
    "tools/coloring", "tools/plans",
    "tools/map_edits",
    "tools/foxglove", "tools/viewer", "tools/setup", "tools/report", "tools/run", "tools/map_merge",
    "tools/map_changes", "tools/dds",
    "tools/dds_plugin", "tools/publishing", "tools/live", "tools/evaluation",
    "tools/inspection", "tools/export", "tools/fleet", "tools/cli", "tools/commands",
    "benchmarks/reference", "benchmarks/verify", "benchmarks", "tools/python", "tests",
]
# Includes of the project's own files begin so, that none can collide with a user's.
PREFIX = "adit/"
# Headers that the build writes, from engine/version.hpp.in.
GENERATED = {"version.hpp"}
# The sources of a page, which are no C++: one level more.
PAGE = "tools/viewer/page/"
# Where threads may be started: tests and benchmarks aside.
THREADS = {"engine/self_test/", "tools/live/", "tools/publishing/",
           "slam/executor/", "tools/recordings/events_ahead", "tools/support/parallel.hpp",
           "tools/viewer/live_view", "tools/viewer/foxglove_run_feed"}
# What these layers are not to include; they do not print or end the process either (PRINTS).
FORBIDDEN_HEADERS = {
    "engine": {"iostream", "cstdio", "stdio.h"},
    "slam": {"iostream", "fstream", "cstdio", "stdio.h", "filesystem"},
}


def suffix(path):
    return pathlib.PurePosixPath(path).suffix


def is_code(path):
    name = path.rsplit("/", 1)[-1]
    return suffix(path) in CODE or name in {"CMakeLists.txt", "dev"} or path == ".ci/run"


def group(path):
    """Index into GROUPS, or None for files that belong to none."""
    if path == "tools/commands/main.cpp":  # which puts the program together
        return GROUPS.index("tests")
    parts = path.split("/")
    top, folder = parts[0], "/".join(parts[:2])
    if top == "engine" and len(parts) > 2 and folder in GROUPS:
        return GROUPS.index(folder)
    if top in {"slam", "tools"}:
        return GROUPS.index(folder) if folder in GROUPS else None
    if folder in GROUPS:
        return GROUPS.index(folder)
    return GROUPS.index(top) if top in GROUPS else None


def includes(text):
    """(quoted, name) of each #include."""
    return [(quote == '"', name) for quote, name in INCLUDE.findall(text)]


def check_layout(files):
    for path in files:
        parts = path.split("/")
        if len(parts) > 1 and parts[0] not in TOP_FOLDERS and not parts[0].startswith("."):
            yield path, f"'{parts[0]}/' is not one of the top-level folders: {', '.join(sorted(TOP_FOLDERS))}"
        if len(parts) > 3 + path.startswith(PAGE) and not path.startswith("tests/data/"):
            yield path, "more than one level of sub-folders"


def check_text(files):
    for path, text in files.items():
        if is_code(path):
            lines = text.count("\n") + (not text.endswith("\n"))
            if lines > HARD_LIMIT:
                yield path, f"{lines} lines; files are split before {HARD_LIMIT}"
            head = text.split("\n", 4)[:4]
            for tag in SPDX:
                if not any(tag in line for line in head):
                    yield path, f"no '{tag.strip()}' in its first lines"
        if text and not text.endswith("\n"):
            yield path, "does not end with a newline"
        for number, line in enumerate(text.split("\n"), 1):
            if line != line.rstrip():
                yield f"{path}:{number}", "white space at the end of the line"
            if MACHINE_PATH.search(line):
                yield f"{path}:{number}", "names a path of somebody's machine"


def check_markdown(files):
    """Lines of text are short; tables, code blocks and lines that cannot be broken are as long as they are."""
    for path, text in files.items():
        if suffix(path) != ".md":
            continue
        fenced = False
        for number, line in enumerate(text.split("\n"), 1):
            if line.lstrip().startswith("```"):
                fenced = not fenced
            if not fenced and len(line) > MARKDOWN_LIMIT and not line.lstrip().startswith("|") and " " in line.strip():
                yield f"{path}:{number}", f"{len(line)} characters; lines of text end before {MARKDOWN_LIMIT}"


def check_groups(files):
    for path in files:
        if suffix(path) in CXX and path.split("/", 1)[0] in TOP_FOLDERS - {"docs"} and group(path) is None:
            yield path, f"lies in none of the groups of check_tree.py: {', '.join(GROUPS)}"


def check_includes(files):
    for path, text in files.items():
        if suffix(path) not in CXX | GLSL or group(path) is None:
            continue
        top = path.split("/", 1)[0]
        for quoted, name in includes(text):
            inner = name.removeprefix(PREFIX)
            if quoted and inner in GENERATED:
                continue
            if not quoted:
                if name in FORBIDDEN_HEADERS.get(top, ()):
                    yield path, f"includes <{name}>: {top}/ does not print or read files"
                if name in {"thread", "future"} and top not in {"tests", "benchmarks"} and \
                        not any(path.startswith(place) for place in THREADS):
                    yield path, f"includes <{name}>: threads are started in {', '.join(sorted(THREADS))} alone"
            elif not name.startswith(PREFIX) or inner not in files:
                yield path, f'includes "{name}", which is not "{PREFIX}" with a path from the root of the tree'
            elif group(inner) is None or group(inner) > group(path):
                yield path, f'includes "{name}": {GROUPS[group(path)]} may not use what lies above it'
            elif suffix(path) in GLSL and not inner.startswith(("shaders/include/", "shaders/shared/")):
                yield path, f'includes "{name}": shaders include only shaders/include and shaders/shared'
            elif path.startswith("shaders/shared/") and not inner.startswith("shaders/shared/"):
                yield path, f'includes "{name}": shaders/shared is read by C++ and GLSL and stands alone'


def check_silence(files):
    """Libraries report to their caller; only the program prints and ends."""
    for path, text in files.items():
        if suffix(path) not in CXX or path.split("/", 1)[0] not in FORBIDDEN_HEADERS:
            continue
        for number, line in enumerate(text.split("\n"), 1):
            found = PRINTS.search(line.split("//", 1)[0])
            if found:
                yield f"{path}:{number}", f"'{found.group(0)}': engine/ and slam/ neither print nor end the process"


def check_vulkan(files):
    """Vulkan headers are seen by engine/vulkan/ and engine/*.cpp alone, not even through another header."""
    sees = {path for path, text in files.items()
            if suffix(path) in CXX and any(name.startswith("vulkan/") for _, name in includes(text))}
    direct = set(sees)
    grown = True
    while grown:
        more = {path for path, text in files.items()
                if suffix(path) in CXX and any(name.removeprefix(PREFIX) in sees for _, name in includes(text))} - sees
        sees |= more
        grown = bool(more)
    for path in sorted(sees):
        if not re.fullmatch(r"engine/[^/]+[.]cpp|(engine/vulkan|tests/engine)/[^/]+", path):
            how = "includes" if path in direct else "includes, through another header,"
            yield path, f"{how} <vulkan/...>; only engine/vulkan/ and engine/*.cpp do"


# A library that can be replaced in these files; tests use it as an oracle.
SEEN_BY = {"ceres/": {"slam/graph/solver.cpp"}, "glog/": {"slam/graph/solver.cpp"},
           "GeographicLib/": {"slam/gnss/world_frame.cpp"},
           "GeographicLib/Geoid": {"tools/map_products/geoid.cpp"},
           "proj.h": {"tools/map_products/projected_system.cpp"},
           "boost/": {"tools/viewer/view_server.cpp", "tools/publishing/status_server.cpp"}}


def check_libraries(files):
    for path, text in files.items():
        if suffix(path) not in CXX or path.startswith("tests/"):
            continue
        for _, name in includes(text):
            library = max((one for one in SEEN_BY if name.startswith(one)), key=len, default=None)
            if library and path not in SEEN_BY[library]:
                yield path, f"includes <{name}>; only {' and '.join(sorted(SEEN_BY[library]))} do"


def check_command_line(files):
    """CLI11 takes longer to compile than any source that is ours: one does."""
    for path, text in files.items():
        if suffix(path) in CXX and path != "tools/cli/command_line.cpp":
            for _, name in includes(text):
                if name.startswith("CLI/"):
                    yield path, f"includes <{name}>; only tools/cli/command_line.cpp does"


# What reads variables of the environment, and where they are listed: rows of a table under a heading.
READS_ENVIRONMENT = re.compile(r"\b(secure_)?getenv\b|\bos\.environ\b")
VARIABLE = re.compile(r"""["']([A-Z][A-Z0-9_]{2,})["']""")
ENVIRONMENT_PAGE, ENVIRONMENT_HEADING = "docs/running.md", "## The environment"


def check_environment(files):
    """A page lists the variables that the program and the Python package read: those and no others."""
    section = files.get(ENVIRONMENT_PAGE, "").partition(ENVIRONMENT_HEADING + "\n")[2].partition("\n## ")[0]
    rows = [line.split("|")[1] for line in section.split("\n") if line.startswith("| `")]
    listed = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    read = set()
    for path, text in files.items():
        if not path.startswith(("engine/", "slam/", "tools/", "benchmarks/")) or suffix(path) not in CXX | {".py"}:
            continue
        names = set(VARIABLE.findall(text)) if READS_ENVIRONMENT.search(text) else set()
        if "temp_directory_path" in text:  # which reads it
            names.add("TMPDIR")
        for name in sorted(names - listed):
            yield path, f"reads {name}, which is not in the table of {ENVIRONMENT_PAGE}, '{ENVIRONMENT_HEADING}'"
        read |= names
    for name in sorted(listed - read):
        yield ENVIRONMENT_PAGE, f"lists {name}, which nothing reads"


def check_headers(files):
    for path, text in files.items():
        if suffix(path) not in {".hpp", ".h"}:
            continue
        if "#pragma once" not in text and not re.search(r"^#ifndef \w+\n#define \w+$", text, re.MULTILINE):
            yield path, "has neither #pragma once nor an include guard"
        if re.search(r"^\s*using namespace ", text, re.MULTILINE):
            yield path, "'using namespace' in a header"


def check_links(files, folders):
    for path, text in files.items():
        if suffix(path) != ".md":
            continue
        here = pathlib.PurePosixPath(path).parent
        for target, _ in LINK.findall(text):
            if re.match(r"[a-z]+:", target):
                continue
            parts = []
            for part in (here / target).parts:
                if part == "..":
                    parts = parts[:-1]
                else:
                    parts.append(part)
            resolved = "/".join(parts)
            if resolved not in files and resolved not in folders:
                yield path, f"links to {target}, which does not exist"


def check(files):
    """All violations in a tree given as {path: text}, as sorted 'path: message' lines."""
    folders = {str(parent) for path in files for parent in pathlib.PurePosixPath(path).parents}
    found = [*check_layout(files), *check_text(files), *check_markdown(files), *check_groups(files),
             *check_includes(files), *check_silence(files), *check_vulkan(files), *check_libraries(files), *check_command_line(files),
             *check_environment(files), *check_headers(files), *check_links(files, folders)]
    return sorted(f"{path}: {message}" for path, message in found)


def read_tree(root):
    """Tracked files and new ones that git does not ignore; binary files have an empty text."""
    listing = subprocess.run(
        ["git", "-C", str(root), "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--deduplicate"],
        check=True, capture_output=True).stdout.decode()
    files = {}
    for path in filter(None, listing.split("\0")):
        full = root / path
        if not full.is_file():
            continue
        try:
            files[path] = full.read_bytes().decode("utf-8")
        except UnicodeDecodeError:
            files[path] = ""
    return files


def plan(files):
    """A line a group, lowest first; then how many includes go up and how many groups include each other in a circle."""
    rows = {index: [0, 0, set()] for index in range(len(GROUPS))}
    up = 0
    for path, text in files.items():
        index = group(path)
        if suffix(path) not in CXX | GLSL or index is None:
            continue
        rows[index][0] += 1
        rows[index][1] += text.count("\n")
        for quoted, name in includes(text):
            other = group(name.removeprefix(PREFIX)) if quoted else None
            if other is not None and other != index:
                rows[index][2].add(other)
                up += other > index
    for index, (count, lines, below) in rows.items():
        if count:
            yield f"{GROUPS[index]:20} {count:4} files {lines:6} lines  <- {', '.join(GROUPS[i] for i in sorted(below))}"
    circles = sum(1 for i, row in rows.items() for j in row[2] if j > i and i in rows[j][2])
    yield f"includes that go up: {up}; groups that include each other: {circles}"


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--plan"]
    root = pathlib.Path(arguments[0] if arguments else pathlib.Path(__file__).parent.parent).resolve()
    files = read_tree(root)
    if "--plan" in sys.argv:
        print("\n".join(plan(files)))
    problems = check(files)
    for problem in problems:
        print(problem)
    print(f"check_tree: {len(files)} files, {len(problems)} problems", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
