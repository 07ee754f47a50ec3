#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Manual pages and completions: all that `--help` names is in them, mandoc finds nothing wrong, and shells complete.

Usage: shells.py ADIT. What a shell is asked is typed into it, and what it shows is read. A shell or mandoc that is not
installed is an error: `./dev setup` installs them.
"""

import os
import pathlib
import pty
import re
import select
import subprocess
import sys
import tempfile
import time

LIMIT_S = 20.0
OPTION = re.compile(r"^  (-\S+)", re.MULTILINE)
COMMAND = re.compile(r"^  ([a-z]+) ", re.MULTILINE)
# What is typed, up to the tabulator key; what the line must become, or what must be offered; what must not be.
CASES = [
    ("adit recov", ["adit recover "], []),
    ("adit run --presen", [], ["--preset"]),
    ("adit run --prese", ["adit run --preset"], []),
    ("adit run --preset kitti-r", ["adit run --preset kitti-raw"], []),
    ("adit export --frame geo", ["adit export --frame geodetic"], []),
    ("adit devices --color al", ["adit devices --color always"], []),
    ("adit info --log dri", ["adit info --log drive.mcap"], []),
    ("adit help dev", ["adit help devices"], []),
    ("adit run -o out dri", ["adit run -o out drive.mcap"], []),
    ("adit run other.bag --topic dri", [], ["drive.mcap"]),
    ("adit simulate offi", ["adit simulate office"], []),
]


def problem(text):
    sys.exit(f"shells: {text}")


def sections(adit, words=()):
    """(words, help) of the program and of all commands below it."""
    text = subprocess.run([adit, *words, "--help"], capture_output=True, text=True, check=True).stdout
    yield words, text
    if "\nSubcommands:\n" in text:
        below = text.split("\nSubcommands:\n", 1)[1].split("\n\n", 1)[0]
        for name in COMMAND.findall(below + "\n"):
            yield from sections(adit, (*words, name))


def check_contents(adit, share):
    """Each command has a page; each option and command is in its page and in the completions."""
    bash = (share / "bash-completion/completions/adit").read_text()
    zsh = (share / "zsh/site-functions/_adit").read_text()
    fish = (share / "fish/vendor_completions.d/adit.fish").read_text()
    pages = {page.name for page in (share / "man/man1").iterdir()}
    for words, text in sections(adit):
        name = "-".join(("adit", *words)) + ".1"
        if name not in pages:
            problem(f"there is no {name}")
        pages.remove(name)
        page = (share / "man/man1" / name).read_text()
        options = [one for names in OPTION.findall(text.split("\nSubcommands:\n")[0]) for one in names.split(",")]
        if "--help" not in options:
            problem(f"no options are found in the help of {words}")
        command = " ".join(("adit", *words))
        line = re.search(rf"^ *'{command}'\) options='([^']*)'", bash, re.MULTILINE)
        for option in options:
            if option.replace("-", "\\-") not in page:
                problem(f"{name} lacks {option}")
            if line is None or option not in line.group(1).split():
                problem(f"bash does not know {command} {option}")
            if not re.search(rf"'[^'[]*(?<![\w-]){option}=?\[", zsh):
                problem(f"zsh does not know {option}")
            dashless = f"-l {option[2:]}" if option.startswith("--") else f"-s {option[1:]}"
            if not re.search(rf"__adit_at {command}'.* {dashless} ", fish):
                problem(f"fish does not know {command} {option}")
    if pages:
        problem(f"no command has {', '.join(sorted(pages))}")


def check_manual(share):
    for page in sorted((share / "man/man1").iterdir()):
        said = subprocess.run(["mandoc", "-Tlint", "-Wwarning", page], capture_output=True, text=True, check=False).stdout
        # The pages have no date: the same options give the same bytes.
        said = [line for line in said.splitlines() if "missing date" not in line]
        if said:
            problem("\n".join(said))
    text = subprocess.run(["mandoc", "-Tutf8", share / "man/man1/adit-run.1"], capture_output=True, text=True, check=True)
    text = re.sub(".\b", "", text.stdout)
    for part in ("adit-run - Map a recording", "SYNOPSIS", "--map-resolution M", "EXIT STATUS", "ADIT_DEVICE"):
        if part not in text:
            problem(f"adit-run.1 shows no '{part}':\n{text}")


class Shell:
    """An interactive shell on a terminal of its own."""

    def __init__(self, command, folder, environment):
        self.process, self.terminal = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            os.execvpe(command[0], command, environment)

    def read(self, quiet_s):
        """What it has printed by the time it has been quiet for so long."""
        shown, end = "", time.monotonic() + LIMIT_S
        while time.monotonic() < end and select.select([self.terminal], [], [], quiet_s)[0]:
            try:
                shown += os.read(self.terminal, 65536).decode(errors="replace")
            except OSError:
                break
        return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b[=>]|\r|\x07", "", shown)

    def type(self, text, quiet_s=0.4):
        os.write(self.terminal, text.encode())
        return self.read(quiet_s)

    def end(self):
        os.close(self.terminal)
        os.waitpid(self.process, 0)


def check_terminal(command, setup, folder, environment):
    """In bash and zsh: what the line looks like after the tabulator key."""
    shell = Shell(command, folder, environment)
    shell.read(1.0)
    shell.type(setup + "\n", 1.0)
    for typed, expected, absent in CASES:
        shown = shell.type(typed + "\t")
        shell.type("\x15")  # empties the line
        shown = shown.replace("\x08", "")
        for part in expected:
            if part not in shown:
                problem(f"{command[0]}: '{typed}' and the tabulator show no '{part}': {shown!r}")
        for part in absent:
            if part in shown:
                problem(f"{command[0]}: '{typed}' and the tabulator show '{part}': {shown!r}")
    shell.end()


def check_fish(share, folder, environment):
    """fish tells what it would offer."""
    script = share / "fish/vendor_completions.d/adit.fish"
    for typed, expected, absent in CASES:
        said = subprocess.run(["fish", "--no-config", "-c", f"source {script}; complete -C '{typed}'"], cwd=folder,
                              capture_output=True, text=True, env=environment, check=True, timeout=LIMIT_S)
        offered = [line.split("\t")[0] for line in said.stdout.splitlines()]
        for line in expected:
            if line.split()[-1] not in offered:
                problem(f"fish: '{typed}' offers {offered}, not {line}: {said.stderr}")
        for part in absent:
            if part in offered:
                problem(f"fish: '{typed}' offers {part}")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    adit = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        share, here = pathlib.Path(folder) / "share", pathlib.Path(folder) / "here"
        here.mkdir()
        (here / "drive.mcap").touch()
        subprocess.run([adit, "generate", share], check=True)
        check_contents(adit, share)
        check_manual(share)
        environment = {"PATH": f"{adit.parent}:{os.environ['PATH']}", "HOME": folder, "TERM": "dumb", "PS1": "> ",
                       "LC_ALL": "C.UTF-8"}
        check_terminal(["bash", "--norc", "--noprofile", "-i"],
                       f"bind 'set bell-style none'; source {share}/bash-completion/completions/adit", here, environment)
        check_terminal(["zsh", "-f", "-i"],
                       f"fpath=({share}/zsh/site-functions $fpath); autoload -U compinit; compinit -u -D", here, environment)
        check_fish(share, here, environment)
    print("shells: manual pages and completions are right")


if __name__ == "__main__":
    main()
