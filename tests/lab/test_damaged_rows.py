"""A study with invalid rows ends with an error that names the line or the invalid object, and writes no file."""
import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

raya = pytest.importorskip("raya", reason="the module is not built; configure with -DRAYA_PYTHON=ON")
from raya.lab import Page, Plot, Series, Table, document, plots, worker  # noqa: E402
from raya.lab.document import write_page  # noqa: E402

OPTIONS = SimpleNamespace(size=None, views=None, seed=1, device=None, no_tuned=True, verbosity=0, shard=None, merge=[], version="")
STUDY = '''"""Damaged rows

What becomes of them?

- Of {{count}} rows.
"""
import numpy as np
import pandas as pd
from raya.lab import Comparison, Page, Plot, Series, Table, above, estimate, judged


def run(lab, scenes):
    rows = pd.DataFrame({{"p": [0, 8, 16], "u": [1.5, 0.4, 0.1]}})
    {damage}
    return Page({{"count": len(rows)}}, [f"u is {{estimate(rows['u']).text()}}."],
                [Comparison("u(16)", "", 0.118, rows["u"].iloc[-1])], tables=[Table("damaged", "u", rows)],
                plots=[Plot("damaged", "u", "p", "u", [Series("u", rows["p"], rows["u"])])])
'''
# {code that damages the rows: expected parts of the error message}
DAMAGES = {"rows = rows.drop(columns='u')": ["damaged.py, line 15", "KeyError", "'u'"],
           "rows['u'] = rows['u'].where(rows['p'] < 16)": ["comparison 'u(16)'", "nan", "not a number"],
           "rows = rows[rows['p'] > 16]": ["damaged.py, line 15"],
           "rows['u'] = ['1.5', 'much', '0.1']": ["damaged.py, line 15", "ValueError", "much"],
           "rows['p'] = ['0', 'eight', '16']": ["series u", "eight"],
           "rows.columns = ['u', 'u']": ["damaged.py, line 15"],
           "return Page({}, tables=[Table('damaged', 'u', [])])": ["table damaged", "no rows"],
           "return Page({})": ["its docstring has {count}, which is not a setting"],
           "return Page({'count': 3}, claims=[judged('u-falls', above(rows['u']))])": ["damaged.py, line 14", "KeyError", "u-falls"],
           "rows['u'] = above(['much'])": ["damaged.py, line 14", "ValueError", "much"],
           "return Page({'count': 3}, tables=2 * [Table('damaged', 'u', rows)])": ["two files have the same name"],
           "return None": ["returns NoneType, not a Page"]}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(worker, "laboratory", None)
    return tmp_path


def study_with(folder, damage):
    file = folder / "damaged.py"
    file.write_text(STUDY.format(damage=damage))
    return str(file)


@pytest.mark.parametrize("damage", DAMAGES)
def test_error_names_the_damage(folder, damage):
    with pytest.raises(ValueError) as error:
        worker.run_study(study_with(folder, damage), [], folder, OPTIONS)
    assert str(error.value).startswith("study damaged: ")
    for part in DAMAGES[damage]:
        assert part in str(error.value)


def test_program_with_damaged_rows_writes_no_files(folder):
    path = os.pathsep.join([str(Path(raya.__file__).absolute().parents[1]), os.environ.get("PYTHONPATH", "")])
    run = subprocess.run([sys.executable, "-m", "raya.lab", study_with(folder, next(iter(DAMAGES))), "-o", str(folder / "made/x"), "--no-tuned"],
                         text=True, capture_output=True, env={**os.environ, "PYTHONPATH": path}, timeout=120)
    assert run.returncode == 2 and run.stdout == ""
    assert run.stderr.startswith("raya: study damaged: damaged.py, line 15: KeyError") and run.stderr.count("\n") == 1
    assert not (folder / "made").exists()


def page_of(**members):
    series = [Series("u", [0, 1], [1.5, 0.4])]
    return Page({}, tables=[Table("loads", "u", [{"p": 0}])], plots=[Plot("loads", "u", "p", "u", series)],
                **members).describe("loads", "Loads")


@pytest.mark.parametrize("module, name", [(plots, "files_of"), (document, "json_of"), (document, "environment")])
def test_page_with_an_error_leaves_no_file(tmp_path, monkeypatch, module, name):
    def fail(*_):
        raise ValueError("injected")

    monkeypatch.setattr(module, name, fail)
    with pytest.raises(ValueError, match="injected"):
        write_page(tmp_path, page_of())
    assert not list(tmp_path.iterdir())


def test_failed_write_leaves_no_partial_file(tmp_path, monkeypatch):
    def fail(*_):
        raise OSError("injected")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="injected"):
        write_page(tmp_path, page_of())
    assert not list(tmp_path.iterdir())


def test_missing_and_infinite_values_are_shown(tmp_path):
    table = Table("loads", "u", [{"p": 0, "u": np.nan}, {"p": 1, "u": np.inf}])
    page = Page({}, tables=[table], plots=[Plot("loads", "u", "p", "u", [Series("u", [0, 1], [np.nan, np.inf])])])
    write_page(tmp_path, page.describe("loads", "Loads"))
    assert (tmp_path / "loads.csv").read_text() == "p,u\n0,-\n1,inf\n"
    assert json.loads((tmp_path / "loads.json").read_text())["tables"][0]["rows"] == [[0, None], [1, "inf"]]
    assert "| 0 | - |\n| 1 | inf |\n" in (tmp_path / "loads.md").read_text()
