# SPDX-License-Identifier: MIT OR Apache-2.0
"""The Python listings of the manual, run as they stand there, print what stands below them."""

import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[2]
LISTING = re.compile(r"```python\n(.*?)```(?:(?!```).)*```text\n(.*?)```", re.DOTALL)
TUTORIAL = (ROOT / "docs/tutorial.md").read_text(encoding="utf-8")


def test_every_listing_has_its_output():
    assert len(LISTING.findall(TUTORIAL)) == TUTORIAL.count("```python") > 0


@pytest.mark.parametrize("program, output", LISTING.findall(TUTORIAL))
def test_listing(program, output):
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr, ended.stdout) == (0, "", output)
