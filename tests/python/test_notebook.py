# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""The notebooks: their cells run from the first to the last, without Jupyter, and nothing of a run is stored in them."""

import json
import re

import matplotlib
import numpy as np
import pytest

from conftest import ROOT

matplotlib.use("Agg")  # before anything draws: no window

import matplotlib.pyplot as plt  # noqa: E402

FOLDER = ROOT / "docs" / "notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def cells(file, kind):
    return [cell for cell in json.loads(file.read_text())["cells"] if cell["cell_type"] == kind]


def source(cell):
    return "".join(cell["source"])


def run(file):
    """What the notebook's names stand for in the end."""
    names = {"__name__": "__main__"}
    for cell in cells(file, "code"):
        exec(compile(source(cell), f"{file.name}, cell {cell['id']}", "exec"), names)
    return names


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_nothing_of_a_run_is_stored(file):
    notebook = json.loads(file.read_text())
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    identities = [cell["id"] for cell in notebook["cells"]]
    assert len(identities) == len(set(identities))
    for cell in cells(file, "code"):
        assert cell["outputs"] == [] and cell["execution_count"] is None, source(cell)


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_links_lead_somewhere(file):
    for cell in cells(file, "markdown"):
        for target in re.findall(r"\]\(([^)#]+)", source(cell)):
            assert target.startswith("https:") or (FOLDER / target).exists(), target


def test_first_map_draws_evaluates_and_aligns(capsys):
    plt.close("all")
    names = run(FOLDER / "first_map.ipynb")
    assert names["slam"].verdict.trust == "reliable"
    assert names["evaluation"].ate.rmse < 0.02
    assert names["alignment"].usable
    np.testing.assert_allclose(names["alignment"].T_a_b, names["by_the_map"], rtol=0.0, atol=0.03)
    assert len(plt.get_fignums()) == 2
    plt.figure(plt.get_fignums()[0]).canvas.draw()
    assert "ATE 0.0" in capsys.readouterr().out
    plt.close("all")
