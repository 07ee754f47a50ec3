# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""The package itself: stubs, the program, the names, the guide."""

import ast
import inspect
import os
import re
import subprocess
import sys
import textwrap

import pytest

import adit
from adit import _adit
from conftest import PACKAGE, PATHS, ROOT

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
    """Runs Python with the package that is tested."""
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, timeout=300,
                          env={**os.environ, **PATHS}, **more)


def test_the_stubs_are_strict(tmp_path):
    (tmp_path / "use.py").write_text(USE)
    answer = python("-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), "-p", "adit", cwd=tmp_path)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    answer = python("-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), "use.py", cwd=tmp_path)
    assert answer.returncode == 0, answer.stdout + answer.stderr


def parameters(signature):
    """Names of the parameters in "name(self: adit.X, a: int = 3, *, b: str) -> str" as pybind11 writes it."""
    inside = signature[signature.index("(") + 1:signature.rindex(") ->")]
    names, depth = [""], 0
    for letter in inside:
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            names.append("")
        else:
            names[-1] += letter
    return [re.split("[:=]", name)[0].strip().lstrip("*") for name in names if name.strip() not in ("", "*")]


def overloads(function):
    """The parameters of a function of the module, without self, an entry an overload."""
    lines = [line for line in (function.__doc__ or "").split("\n")
             if re.match(rf"(\d+[.] )?{function.__name__}[(].*[)] ->", line)]
    return [[name for name in parameters(line) if name not in ("self", "arg0", "")] for line in lines]


def test_the_stubs_are_those_of_the_module():
    tree = ast.parse((PACKAGE / "_adit.pyi").read_text())
    stubs = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert set(stubs) == {name for name in vars(_adit) if not name.startswith("_")}
    for name, stub in stubs.items():
        if isinstance(stub, ast.FunctionDef):
            compare_parameters(name, [stub], getattr(_adit, name))
            continue
        members = {}
        for node in stub.body:
            if isinstance(node, ast.FunctionDef):
                members.setdefault(node.name, []).append(node)
        runtime = vars(getattr(_adit, name))
        assert {m for m in members if not m.startswith("_")} == {m for m in runtime if not m.startswith("_")}, name
        for member, nodes in members.items():
            decorators = {ast.unparse(d) for node in nodes for d in node.decorator_list}
            if "property" in decorators:
                assert isinstance(runtime[member], property), f"{name}.{member}"
            elif member in runtime and not member.startswith("__") or member == "__init__":
                compare_parameters(f"{name}.{member}", nodes, getattr(getattr(_adit, name), member))


def compare_parameters(name, nodes, function):
    found = overloads(function)
    said = [[a.arg for a in (*node.args.args, *node.args.kwonlyargs) if a.arg != "self"]
            + ([node.args.kwarg.arg] if node.args.kwarg else []) for node in nodes]
    if len(found) > len(said) == 1:  # the stub has one with a union of types
        found = found[:1]
    if found and found[0][-1:] == ["kwargs"]:
        found, said = [found[0][:-1]], [said[0][:-1]]
    assert said == found, name


def shape(parameter):
    """What a stub and inspect both say of a parameter: how it is given, and whether it must be."""
    return parameter.name, parameter.kind.name, parameter.default is not parameter.empty


def stubbed(node):
    """The signature of a function in the stubs."""
    names = {}
    exec(compile(ast.unparse(ast.Module([ast.FunctionDef(
        node.name, ast.arguments(
            node.args.posonlyargs, [ast.arg(a.arg) for a in node.args.args],
            node.args.vararg and ast.arg(node.args.vararg.arg), [ast.arg(a.arg) for a in node.args.kwonlyargs],
            node.args.kw_defaults, node.args.kwarg and ast.arg(node.args.kwarg.arg), node.args.defaults),
        [ast.Pass()], [], lineno=0)], [])), "stub", "exec"), names)
    return [shape(one) for one in inspect.signature(names[node.name]).parameters.values()]


def test_signatures_can_be_inspected_and_are_those_of_the_stubs():
    tree = ast.parse((PACKAGE / "_adit.pyi").read_text())
    for node in tree.body:
        if isinstance(node, ast.FunctionDef):
            found = inspect.signature(getattr(_adit, node.name)).parameters.values()
            assert [shape(one) for one in found] == stubbed(node), node.name
        if not isinstance(node, ast.ClassDef) or issubclass(getattr(_adit, node.name), Exception):
            continue
        cls = getattr(_adit, node.name)
        methods = {}  # of several overloads the one with the most parameters
        for one in node.body:
            if isinstance(one, ast.FunctionDef) and not any(ast.unparse(d) == "property" for d in one.decorator_list):
                longest = methods.get(one.name)
                if longest is None or len(stubbed(one)) > len(stubbed(longest)):
                    methods[one.name] = one
        for name, method in methods.items():
            if name in ("__eq__", "__exit__"):
                continue
            found = [shape(one) for one in inspect.signature(getattr(cls, name)).parameters.values()]
            assert found == stubbed(method), f"{node.name}.{name}"
        made = [shape(one) for one in inspect.signature(cls).parameters.values()]
        if "__init__" in methods:
            assert made == stubbed(methods["__init__"])[1:], node.name
        assert cls.__doc__ and "--" not in cls.__doc__.split("\n")
    assert str(inspect.signature(adit.open)) == "(path, config=None, *, strict=False)"
    assert str(inspect.signature(adit.Odometry)) == "(config=None, *, device=None)"
    assert str(inspect.signature(adit.Aligner)).endswith("min_overlap=0.4, device=None)")
    for name in adit.__all__:
        value = getattr(adit, name)
        if callable(value) and not (isinstance(value, type) and issubclass(value, Exception)):
            inspect.signature(value)
    assert "open(path" in inspect.getdoc(adit.open) or "Opens an MCAP" in inspect.getdoc(adit.open)


def test_a_repr_shows_what_an_object_is(mapped, drive, room):
    file, report, placed = mapped
    map_ = adit.Map(file)
    assert re.fullmatch(r"<adit.Edge from_=0 to=1 kind='odometry' status='active'>", repr(map_.edges[0]))
    assert re.match(r"<adit.MapReport keyframes=\d+ sweeps=\d+ .*georeferenced=(True|False)>", repr(report))
    assert re.match(r"<adit.RegistrationResult status='converged' overlap=0\.\d+", repr(placed[-1].result.registration))
    assert re.match(r"<adit.Submap of \d+ keyframe=0 ", repr(map_.submap(0)))
    assert re.fullmatch(r"<adit.Georeference origin=\(\d+\.\d+, \d+\.\d+, \d+\.\d+\)>", repr(map_.georeference))
    assert re.fullmatch(r"<adit.MapSession id=\d+ name='drive.mcap'>", repr(map_.sessions[0])), "without its configuration"
    assert repr(adit.Odometry()) == "<adit.Odometry before its first sweep>"
    assert repr(adit.Aligner()) == "<adit.Aligner vgicp, resolution 0, min_overlap 0.4>"
    for name in adit.__all__:
        value = getattr(adit, name)
        if isinstance(value, type) and value.__module__ == "adit._adit":
            assert "__repr__" in vars(value), name


def test_files_are_closed_at_the_end_of_a_block(drive, mapped):
    with adit.open(drive) as recording:
        events = iter(recording)
        next(events)
        placed = adit.Slam.for_recording(recording).process(recording)
    assert recording.closed and recording.damage == [] and recording.path == drive
    assert "closed" in repr(recording)
    for use in (lambda: next(events), lambda: next(placed), lambda: iter(recording), lambda: recording.topics,
                lambda: recording.has_imu, lambda: adit.Slam.for_recording(recording)):
        with pytest.raises(ValueError, match="drive.mcap: the recording is closed"):
            use()
    recording.close()  # again, which does nothing
    assert str(drive) not in [os.readlink(f"/proc/self/fd/{name}") for name in os.listdir("/proc/self/fd")
                              if os.path.exists(f"/proc/self/fd/{name}")]
    with adit.Map(mapped[0]) as map_:
        assert map_.keyframes
    with pytest.raises(ValueError, match="the map is closed"):
        map_.keyframes
    assert str(mapped[0]) in repr(map_)


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


@pytest.mark.skipif(_adit.__pybind11__ >= (2, 12), reason="this pybind11 knows NumPy 2")
def test_a_numpy_that_would_be_misread_is_refused():
    answer = python("-c", "import sys, types, importlib.util as util\n"
                    "sys.modules['numpy'] = types.ModuleType('numpy')\nsys.modules['numpy'].__version__ = '2.1.0'\n"
                    f"util.module_from_spec(util.spec_from_file_location('adit._adit', {_adit.__file__!r}))")
    assert answer.returncode == 1 and "cannot read NumPy 2.1.0. Install numpy<2" in answer.stderr


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
        if "__main__" in block:  # a program of its own
            (tmp_path / "example.py").write_text(block)
            answer = python("example.py", cwd=tmp_path)
            assert answer.returncode == 0 and answer.stdout, answer.stderr
        else:
            exec(compile(textwrap.dedent(block), "docs/python.md", "exec"), names)
