# SPDX-License-Identifier: MIT OR Apache-2.0
"""docs/hosts/frame_rates.csv, of which the page of all measurements draws the hosts, says what the hosts' pages say."""

import csv
import pathlib

import pytest

ROOT = pathlib.Path(__file__).parents[2]
CSV = ROOT / "docs/hosts/frame_rates.csv"
ROWS = list(csv.DictReader(CSV.read_text(encoding="utf-8").splitlines()[1:]))

# By page, the columns of its table and theirs in the file.
COLUMNS = {
    "docs/mujoco.md": {"scene": "scene", "dt, s": "time_step", "contact": "contact", "ms a step": "ms_per_step"},
    "docs/sofa.md": {"variant": "contact", "steps/s": "frames_per_second", "ms of a step": "ms_per_step"},
    "docs/stability.md": {
        "contact": "contact",
        "time step / s": "time_step",
        "frames a second": "frames_per_second",
    },
    "docs/contact_system.md": {"command, in `build/test/demos`": "scene", "ms of a step": "ms_per_step"},
}


def cells(line):
    return [cell.strip().strip("`") for cell in line.strip("|").split("|")]


def told(page, columns):
    """The rows of the page's table, by the columns of the file; those without a figure are left out."""
    lines = (ROOT / page).read_text(encoding="utf-8").splitlines()
    names = [cell.strip("`") for cell in columns]
    first = next(i for i, line in enumerate(lines) if line.startswith("|") and set(names) <= set(cells(line)))
    head = cells(lines[first])
    for line in lines[first + 2 :]:
        if not line.startswith("|"):
            return
        row = dict(zip(head, cells(line)))
        found = {column: row[name] for name, column in zip(names, columns.values())}
        if found.get("ms_per_step", "-") != "":
            yield found


@pytest.mark.parametrize("page", COLUMNS)
def test_the_page_and_the_file_agree(page):
    columns = COLUMNS[page].values()
    wanted = [{column: row[column] for column in columns} for row in ROWS if row["page"] == page]
    assert len(wanted) > 5
    assert list(told(page, COLUMNS[page])) == wanted


def test_every_row_has_a_page_and_a_figure():
    assert {row["page"] for row in ROWS} == set(COLUMNS)
    assert {row["by"] for row in ROWS} == {"raycontact", "host", "both", "none"}
    for row in ROWS:
        figures = [row["frames_per_second"], row["ms_per_step"]]
        assert all(float(figure) > 0 for figure in figures if figure) and any(figures), row
        if all(figures):  # the page rounds both
            assert float(figures[0]) * float(figures[1]) == pytest.approx(1000, rel=0.03)
