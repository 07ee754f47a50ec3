#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Runs every block of commands of the README and the guides, as a reader would type them.

Usage: guides.py ADIT [PAGE...]: ADIT is the program; without pages all of them. Prints what is wrong and exits 1 if
anything is.

A block of commands is a fenced block marked `sh` (one command a line) or `console` (commands behind "$ ", then what
they print: numbers may differ, a line "..." stands for any lines). The blocks of a page run one after the other in an
empty folder. It holds drive.mcap, its ground truth and points.csv if the page names one of them. What cannot run here is
listed in NOT_RUN. Of these commands, and of those within sentences, verbs and options must exist.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Beginnings of commands that are not run, with the reason. An entry that no page needs is an error.
NOT_RUN = {
    "./dev ": "installs packages and builds",
    "adit bench": "takes minutes",
    "adit view ": "serves until it is ended; tests/viewer does that",
    "adit run drive.mcap --view": "likewise",
    "sudo apt install": "needs root, and what the line before it builds",
    "pip install tools/python": "builds",
    "python3 -m venv": "needs the network",
    "cmake --": "is what tests/installed.py does",
    "g++ ": "is what tests/installed.py does",
    "v/bin/python": "needs what the line before it installs",
    "ADIT_DEVICE=0 build": "is about a device of the reader's machine",
}
# The recording that every page may use, and its ground truth.
PREPARED = ("simulate", "room", "--sensor", "VLP-16", "--duration", "4", "--seed", "5", "-o", "drive.mcap")
NEEDS_PREPARED = re.compile(r"\bdrive\.(mcap|truth)|\bpoints\.csv")  # only such pages wait for it
LIMIT_S = 240.0  # of one command
FENCE = re.compile(r"^\s*```(.*)$")
COMMAND = re.compile(r"^\s*(\$ |adit |\./dev )")
SPAN = re.compile(r"`((?:adit|\./dev) [^`]*)`")
OPTION = re.compile(r"(?<![\w-])(--?[a-z][a-z-]*)")
NUMBER = re.compile(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}|[-+]?\d[\d.,:]*(e[-+]?\d+)?")


class Problem(Exception):
    pass


def blocks(text):
    """(line number, info, lines) of each fenced block."""
    found, info, begin, lines = [], None, 0, []
    for number, line in enumerate(text.split("\n"), 1):
        fence = FENCE.match(line)
        if fence and info is None:
            info, begin, lines = fence.group(1).strip(), number, []
        elif fence:
            found.append((begin, info, lines))
            info = None
        elif info is not None:
            lines.append(line)
    return found


def commands(info, lines):
    """[command, lines it should print] of a block; comments and continued lines are joined up."""
    found = []
    for line in lines:
        if info == "sh":
            line = re.sub(r"(^|\s+)#.*$", "", line)
            if found and found[-1][0].endswith("\\"):
                found[-1][0] = found[-1][0][:-1] + line.strip()
            elif line.strip():
                found.append([line.strip(), []])
        elif line.startswith("$ "):
            found.append([line[2:].strip(), []])
        elif not found:
            raise Problem(f"a console block begins with a command, not with '{line}'")
        else:
            found[-1][1].append(line)
    return found


def shape(line):
    """A line without its numbers and its spacing."""
    return " ".join(NUMBER.sub("#", line).split())


def compare(expected, printed):
    """The first expected line that is not among the printed ones."""
    shapes = {shape(line) for line in printed.split("\n")}
    for line in expected:
        if line.strip() not in ("", "...") and shape(line) not in shapes:
            raise Problem(f"it did not print: {line}")


class Program:
    """What is asked of the program and of ./dev."""

    def __init__(self, adit):
        self.adit = str(pathlib.Path(adit).resolve())
        self.helps = {}

    def help_of(self, words):
        if words not in self.helps:
            answer = subprocess.run([self.adit, *words, "--help"], capture_output=True, text=True, timeout=LIMIT_S)
            self.helps[words] = answer.stdout if answer.returncode == 0 else ""
        return self.helps[words]

    def dev_verbs(self):
        text = subprocess.run([ROOT / "dev", "help"], capture_output=True, text=True, check=True).stdout
        return set(re.findall(r"^  ([a-z][a-z-]*)", text, re.MULTILINE)) | {"help"}

    def prepare(self, folder):
        subprocess.run([self.adit, *PREPARED], cwd=folder, check=True, capture_output=True, timeout=LIMIT_S)
        shutil.copy(ROOT / "tests" / "support" / "points.csv", folder)

    def run(self, command, folder):
        path = f"{pathlib.Path(self.adit).parent}:{os.environ['PATH']}"
        answer = subprocess.run(["bash", "-euo", "pipefail", "-c", command], cwd=folder, capture_output=True, text=True,
                                timeout=LIMIT_S, env={**os.environ, "PATH": path}, stdin=subprocess.DEVNULL)
        if answer.returncode != 0:
            raise Problem(f"exit code {answer.returncode}:\n{answer.stdout}{answer.stderr}")
        return answer.stdout + answer.stderr


def exists(program, command):
    """Verbs and options of a command are there; MAP and the like stand for anything."""
    words = command.replace("|", " ").split()
    if words[0] == "./dev":
        if len(words) > 1 and words[1] not in program.dev_verbs():
            raise Problem(f"./dev has no verb {words[1]}")
        return
    verb = words[1] if len(words) > 1 else ""
    if not re.fullmatch(r"[a-z]+", verb):
        return
    asked = (verb,)
    if verb == "bench" and len(words) > 2 and words[2] in ("slam", "consistency"):
        asked = (verb, words[2])
    text = program.help_of(asked)
    if not text:
        raise Problem(f"there is no command {' '.join(asked)}")
    for option in OPTION.findall(" ".join(words[len(asked) + 1:])):
        if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", text):
            raise Problem(f"adit {' '.join(asked)} has no option {option}")


def check_page(program, page, text, used):
    """Problems of a page, as lines; `used` gets the entries of NOT_RUN that it needs."""
    with tempfile.TemporaryDirectory() as folder:
        prepared = not NEEDS_PREPARED.search(text)
        outside = []
        for number, info, lines in blocks(text):
            if info not in ("sh", "console"):
                outside += [(number, line.strip()) for line in lines if line.strip().startswith(("adit ", "./dev "))]
                if info == "" and any(COMMAND.match(line) for line in lines):
                    yield f"{page}:{number}: a block of commands is marked sh, console or (if it is none) text"
                continue
            try:
                for command, expected in commands(info, lines):
                    entry = next((entry for entry in NOT_RUN if command.startswith(entry.strip())), None)
                    if entry:
                        used.add(entry)
                        if command.startswith(("adit ", "./dev ")):
                            exists(program, command)
                        continue
                    if not prepared:
                        program.prepare(folder)
                        prepared = True
                    begin = time.monotonic()
                    printed = program.run(command, folder)
                    print(f"{page}: {command}: {time.monotonic() - begin:.1f} s", flush=True)
                    compare(expected, printed)
            except (Problem, subprocess.TimeoutExpired) as problem:
                yield f"{page}:{number}: {command}: {problem}"
    prose = re.sub(r"```.*?```", lambda block: "\n" * block.group(0).count("\n"), text, flags=re.DOTALL)
    for match in SPAN.finditer(prose):
        outside.append((prose.count("\n", 0, match.start()) + 1, match.group(1)))
    for number, command in outside:
        try:
            exists(program, command)
        except Problem as problem:
            yield f"{page}:{number}: {command}: {problem}"


def pages():
    """README, guides and what belongs to them; of docs/theory and decisions only the commands within sentences."""
    names = ["README.md", "CONTRIBUTING.md", "benchmarks/README.md", "benchmarks/results/README.md"]
    names += sorted(str(path.relative_to(ROOT)) for path in (ROOT / "docs").glob("*.md"))
    for folder in ("guides", "theory"):
        names += sorted(str(path.relative_to(ROOT)) for path in (ROOT / "docs" / folder).glob("*.md"))
    return names


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    program, used, problems = Program(sys.argv[1]), set(), []
    for page in sys.argv[2:] or pages():
        problems += check_page(program, page, (ROOT / page).read_text(), used)
    if not sys.argv[2:]:
        problems += [f"NOT_RUN: no page needs '{entry}'" for entry in NOT_RUN if entry not in used]
    print("\n".join(problems))
    print(f"guides: {len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
