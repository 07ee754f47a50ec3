#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""The .deb that tools/deb.sh makes of a build: what it holds, that its program runs, that the same tree gives the same bytes.

Usage: deb.py BUILD FOLDER. Whether it installs on a bare system is tried by hand: docs/installing.md has what came out.
"""

import gzip
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FILES = ("usr/bin/adit", "usr/share/man/man1/adit.1.gz", "usr/share/man/man1/adit-run.1.gz",
         "usr/share/bash-completion/completions/adit", "usr/share/zsh/vendor-completions/_adit",
         "usr/share/fish/vendor_completions.d/adit.fish", "usr/share/doc/adit/copyright",
         "usr/lib/systemd/system/adit-live.service", "etc/default/adit-live",
         "usr/share/doc/adit/changelog.gz", "usr/share/doc/adit/changelog.Debian.gz",
         *(f"usr/share/adit/schemas/{file.name}" for file in sorted((ROOT / "docs" / "schemas").iterdir())))


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def require(condition, what):
    if not condition:
        sys.exit(f"deb: {what}")


def main():
    build, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("once", "again"):
        run(ROOT / "tools" / "deb.sh", build, folder / name)
    (archive,) = (folder / "once").iterdir()
    require(archive.read_bytes() == (folder / "again" / archive.name).read_bytes(), "the second has other bytes")

    fields = dict(re.findall(r"^ ?([A-Z][\w-]+): (.*)$", run("dpkg-deb", "--info", archive), re.MULTILINE))
    for needed in ("libc6", "libvulkan1", "mesa-vulkan-drivers | vulkan-icd"):
        require(needed in fields["Depends"], f"it does not depend on {needed}: {fields['Depends']}")

    tree = folder / "tree"
    run("dpkg-deb", "--extract", archive, tree)
    for name in FILES:
        require((tree / name).is_file(), f"it lacks {name}")
    held = {str(path.relative_to(tree)) for path in tree.rglob("*") if path.is_file()}
    strange = [name for name in held if not name.startswith(FILES[3:]) and name not in FILES
               and not re.fullmatch(r"usr/share/man/man1/adit-[a-z-]+[.]1[.]gz|usr/lib/adit/adit_dds[.]so", name)]
    require(not strange, f"it also holds {strange}")
    with gzip.open(tree / "usr/share/doc/adit/changelog.Debian.gz", "rt") as changelog:
        require(changelog.readline().startswith(f"adit ({fields['Version']}) "), "its changelog is of another version")
    require(run(tree / "usr/bin/adit", "--version").startswith(f"adit {fields['Version'].split('-')[0]}\n"),
            "its program does not tell its version")
    print(f"{archive.name}: {archive.stat().st_size} bytes, {len(held)} files, needs {fields['Depends']}")


if __name__ == "__main__":
    main()
