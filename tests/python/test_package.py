# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""The package itself: stubs, the program, the names, the guide."""

import os
import pathlib
import re
import subprocess
import sys
import textwrap

import pytest

import adit
from conftest import ROOT

PACKAGE = pathlib.Path(adit.__file__).parent
USE = '''
import numpy as np
import adit
recording = adit.open("drive.mcap", {"imu": {"use": False}})
slam = adit.Slam.for_recording(recording, map="drive.adit")
stamps: list[int] = []
for sweep in slam.process(recording):
    stamps.append(sweep.stamp)
    x = float(sweep.pose[0, 3])
for event in recording:
    if isinstance(event, adit.Sweep):
        adit.Odometry().register_frame(event.points, event.times, stamp=event.stamp)
        adit.Odometry().register_frame(event)
alignment = adit.align(np.ones((9, 3)), np.ones((9, 3), np.float32), np.eye(4))
ids: list[int] = adit.Map("drive.adit").within([0.0, 0.0, 0.0], np.ones(3))
'''


def python(*arguments, **more):
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, timeout=300, **more)


def test_the_stubs_are_strict(tmp_path):
    pytest.importorskip("mypy")
    (tmp_path / "use.py").write_text(USE)
    answer = python("-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), "-p", "adit", cwd=tmp_path,
                    env={**os.environ, "MYPYPATH": str(PACKAGE.parent)})
    assert answer.returncode == 0, answer.stdout + answer.stderr
    answer = python("-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), "use.py", cwd=tmp_path,
                    env={**os.environ, "MYPYPATH": str(PACKAGE.parent)})
    assert answer.returncode == 0, answer.stdout + answer.stderr


def test_the_stubs_are_those_of_the_module(tmp_path):
    pytest.importorskip("mypy")
    answer = python("-m", "mypy.stubtest", "adit", "--ignore-missing-stub", cwd=tmp_path,
                    env={**os.environ, "MYPYPATH": str(PACKAGE.parent)})
    assert answer.returncode == 0, answer.stdout + answer.stderr


def test_python_m_adit_is_the_program(tmp_path, program, drive):
    answer = python("-m", "adit", "--version")
    assert answer.returncode == 0 and answer.stdout.split("\n")[-2:] == program("--version").split("\n")[-2:]
    assert answer.stdout.startswith(f"adit {adit.version()}\n") and adit.__version__ == adit.version()
    assert python("-m", "adit").returncode == 2
    answer = python("-m", "adit", "rnu")
    assert answer.returncode == 2 and "there is no command 'rnu'" in answer.stderr
    answer = python("-m", "adit", "run", str(tmp_path / "nothing"), "-o", str(tmp_path / "out"))
    assert answer.returncode == 1 and "adit run: " in answer.stderr
    answer = python("-m", "adit", "run", str(drive), "-o", str(tmp_path / "out"), "--count", "3", "--quiet")
    assert answer.returncode == 0 and (tmp_path / "out" / "trajectory.tum").exists()


def test_every_public_name_is_documented():
    for name in adit.__all__:
        value = getattr(adit, name)
        assert value.__doc__, name
        for member in vars(value) if isinstance(value, type) else ():
            if not member.startswith("_"):
                assert getattr(value, member).__doc__ is not None, f"{name}.{member}"


def test_every_block_of_the_guide_runs(drive, tmp_path, monkeypatch):
    page = (ROOT / "docs" / "python.md").read_text()
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    assert len(blocks) >= 5
    for file in drive.parent.iterdir():
        (tmp_path / file.name).symlink_to(file)
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in blocks:
        exec(compile(textwrap.dedent(block), "docs/python.md", "exec"), names)
