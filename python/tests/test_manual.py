# SPDX-License-Identifier: MIT OR Apache-2.0
"""The Python listings of the manual, run as they stand there, print what stands below them."""

import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[2]
LISTING = re.compile(r"```python\n(.*?)```(?:(?!```).)*```text\n(.*?)```", re.DOTALL)
HEADING = re.compile(r"^##+ (.*)$", re.MULTILINE)
NAMES = "README.md", "docs/tutorial.md", "docs/recipes.md", "docs/contact_system.md"
PAGES = {page: (ROOT / page).read_text(encoding="utf-8") for page in NAMES}


def listings():
    for page, text in PAGES.items():
        for found in LISTING.finditer(text):
            heading = HEADING.findall(text[: found.start()])[-1]
            yield pytest.param(*found.groups(), id=f"{page}: {heading}")


@pytest.mark.parametrize("text", list(PAGES.values()), ids=list(PAGES))
def test_every_listing_has_its_output(text):
    assert len(LISTING.findall(text)) == text.count("```python") > 0


@pytest.mark.parametrize("program, output", list(listings()))
def test_listing(program, output):
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr, ended.stdout) == (0, "", output)


def test_the_example_is_the_tutorials_program():
    programs = [program for program, _ in LISTING.findall(PAGES["docs/tutorial.md"])]
    assert programs[-1] == (ROOT / "examples/two_octahedra.py").read_text(encoding="utf-8")
