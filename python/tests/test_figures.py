# SPDX-License-Identifier: MIT OR Apache-2.0
"""README.md and the pages say what the CSV files say, and the check of that finds what does not."""

import pathlib
import shutil
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[2]
BROKEN = {  # a file, what is replaced in it, what is said
    "README.md": ("-->7<!--", "-->6<!--", "README.md: 'poses, steps'"),
    "docs/limits.md": ("-->0.58 to", "-->0.6 to", "limits.md: 'single rays'"),
    "docs/performance_notebook.md": ("| 19.0 | 64.9 |", "| 19.5 | 64.9 |", "19.5 µs on pair20x10"),
    "docs/choosing.md": ("[chart.csv](chart/chart.csv).", "[map.csv](stability/map.csv).", "where stability/map.csv"),
    "docs/options.md": ("# ", "# *Exploratory* ", "options.md has exploratory figures"),
    "docs/accuracy/forces.csv": ("# date", "# from", "forces.csv does not begin with"),
    "docs/performance/instructions.csv": (",5009467", ",7009467", "performance.md: 'instructions'"),
    "docs/performance/queries.csv": (",Embree 3,", ",Embree,", "no figure or column"),
    "docs/performance/deep.csv": (",36612,", ",0,", "no contacts"),
}


def check(root):
    return subprocess.run([sys.executable, root / "scripts/figures.py"], capture_output=True, text=True, check=False)


def test_pages_say_what_their_files_say():
    done = check(ROOT)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", BROKEN)
def test_what_differs_is_found(name, tmp_path):
    for path in [ROOT / "README.md", *ROOT.glob("docs/*.md"), *ROOT.glob("docs/**/*.csv"), *ROOT.glob("scripts/*.py")]:
        copy = tmp_path / path.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, copy)
    before, after, said = BROKEN[name]
    text = (tmp_path / name).read_text(encoding="utf-8")
    assert before in text
    (tmp_path / name).write_text(text.replace(before, after), encoding="utf-8")
    done = check(tmp_path)
    assert done.returncode == 1 and said in done.stderr, done.stderr
