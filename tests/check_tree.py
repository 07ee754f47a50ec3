#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Checks the rules of the tree that no compiler checks; docs/architecture.md gives them.

Usage: check_tree.py [ROOT]. Prints one line a violation and exits 1 if there is any.
"""

import pathlib
import re
import subprocess
import sys

TOP_FOLDERS = {"shaders", "engine", "slam", "tools", "tests", "benchmarks", "docs"}
HARD_LIMIT = 500
CODE = {".cpp", ".hpp", ".h", ".comp", ".glsl", ".py", ".sh", ".cmake"}
CXX = {".cpp", ".hpp", ".h"}
GLSL = {".comp", ".glsl"}
SPDX = ("SPDX-FileCopyrightText: ", "SPDX-License-Identifier: Apache-2.0")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
MACHINE_PATH = re.compile(r"(?<![\w./}$-])/(home|root|work|mnt|Users)/")
PRINTS = re.compile(r"\bstd::(cout|cerr|clog)\b|\b(f?printf|f?puts|putchar)\s*\(|\b(std::)?(exit|abort|quick_exit)\s*\(")
LINK = re.compile(r"\]\(([^)#\s]+)(#[^)\s]*)?\)")
# Layers, lowest first: a file includes its own layer and those below it, never one above.
LAYERS = ["shaders", "engine", "engine/kernels", "slam", "tools", "tests"]
# What these layers are not to include; they do not print or end the process either (PRINTS).
FORBIDDEN_HEADERS = {
    "engine": {"iostream", "cstdio", "stdio.h"},
    "slam": {"iostream", "fstream", "cstdio", "stdio.h", "filesystem", "thread"},
}


def suffix(path):
    return pathlib.PurePosixPath(path).suffix


def is_code(path):
    name = path.rsplit("/", 1)[-1]
    return suffix(path) in CODE or name in {"CMakeLists.txt", "dev"} or path == ".ci/run"


def layer(path):
    """Index into LAYERS, or None for files that are not part of the layering."""
    if path.startswith("engine/kernels/"):
        return LAYERS.index("engine/kernels")
    top = path.split("/", 1)[0]
    if top == "benchmarks" or path == "tools/main.cpp":  # which puts the program together
        return LAYERS.index("tests")
    return LAYERS.index(top) if top in LAYERS else None


def includes(text):
    """(quoted, name) of each #include."""
    return [(quote == '"', name) for quote, name in INCLUDE.findall(text)]


def check_layout(files):
    for path in files:
        parts = path.split("/")
        if len(parts) > 1 and parts[0] not in TOP_FOLDERS and not parts[0].startswith("."):
            yield path, f"'{parts[0]}/' is not one of the top-level folders: {', '.join(sorted(TOP_FOLDERS))}"
        if len(parts) > 3 and not path.startswith("tests/data/"):
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


def check_includes(files):
    for path, text in files.items():
        if suffix(path) not in CXX | GLSL or layer(path) is None:
            continue
        top = path.split("/", 1)[0]
        for quoted, name in includes(text):
            if not quoted:
                if name in FORBIDDEN_HEADERS.get(top, ()):
                    yield path, f"includes <{name}>: {top}/ does not print, read files or start threads"
            elif name not in files:
                yield path, f'includes "{name}", which is not a path from the root of the tree'
            elif layer(name) is None or layer(name) > layer(path):
                yield path, f'includes "{name}": {LAYERS[layer(path)]} may not use what lies above it'
            elif suffix(path) in GLSL and not name.startswith(("shaders/include/", "shaders/shared/")):
                yield path, f'includes "{name}": shaders include only shaders/include and shaders/shared'
            elif path.startswith("shaders/shared/") and not name.startswith("shaders/shared/"):
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
    """Vulkan headers are seen by engine/*.{hpp,cpp} alone, not even through another header."""
    sees = {path for path, text in files.items()
            if suffix(path) in CXX and any(name.startswith("vulkan/") for _, name in includes(text))}
    direct = set(sees)
    grown = True
    while grown:
        more = {path for path, text in files.items()
                if suffix(path) in CXX and any(name in sees for _, name in includes(text))} - sees
        sees |= more
        grown = bool(more)
    for path in sorted(sees):
        if not re.fullmatch(r"(engine|tests/engine)/[^/]+", path):
            how = "includes" if path in direct else "includes, through another header,"
            yield path, f"{how} <vulkan/...>; only engine/*.hpp and engine/*.cpp do"


def check_ceres(files):
    """The solver of pose graphs can be replaced in one file; tests use it as an oracle."""
    for path, text in files.items():
        if suffix(path) not in CXX or path == "slam/mapping/solver.cpp" or path.startswith("tests/"):
            continue
        for _, name in includes(text):
            if name.startswith(("ceres/", "glog/")):
                yield path, f"includes <{name}>; only slam/mapping/solver.cpp does"


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
    found = [*check_layout(files), *check_text(files), *check_includes(files), *check_silence(files),
             *check_vulkan(files), *check_ceres(files), *check_headers(files), *check_links(files, folders)]
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


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent).resolve()
    files = read_tree(root)
    problems = check(files)
    for problem in problems:
        print(problem)
    print(f"check_tree: {len(files)} files, {len(problems)} problems", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
