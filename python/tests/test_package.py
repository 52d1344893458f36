# SPDX-License-Identifier: MIT OR Apache-2.0
"""How the package is built from the repository."""

import os
import pathlib
import subprocess
import sys

from hatchling.builders.sdist import SdistBuilder
from hatchling.builders.wheel import WheelBuilder

ROOT = pathlib.Path(__file__).parents[2]


def test_nothing_looks_into_what_cargo_has_built(monkeypatch):
    """Which may be gigabytes in a hundred thousand files."""
    (ROOT / "target").mkdir(exist_ok=True)
    scan, looked_into = os.scandir, []
    monkeypatch.setattr(os, "scandir", lambda folder: looked_into.append(pathlib.Path(folder)) or scan(folder))
    for builder, file in ((WheelBuilder, "python/raycontact/mesh.py"), (SdistBuilder, "src/mesh/mod.rs")):
        found = {included.relative_path for included in builder(str(ROOT)).recurse_included_files()}
        assert file in found and any(folder.is_relative_to(ROOT / "python") for folder in looked_into)
    assert not [folder for folder in looked_into if folder.is_relative_to(ROOT / "target")]


def test_without_cargo_the_message_stands_alone(tmp_path):
    command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", tmp_path, ROOT]
    ended = subprocess.run(command, env={**os.environ, "PATH": str(tmp_path)}, capture_output=True, text=True)
    told = ended.stdout + ended.stderr
    assert ended.returncode and "cargo is missing: install a Rust toolchain" in told
    assert "Traceback" not in told and 'File "' not in told
