# SPDX-License-Identifier: MIT OR Apache-2.0
"""Writes shapes/*.obj, poses.csv and bodies/*.obj."""

import pathlib

from . import bodies, files, poses, shapes


def generate(folder, seed=1, share=1.0, progress=lambda done, of: None, kinds=None):
    """share: of the counts of a full set; each kind has at least two poses. Each kind of a smaller set is the beginning
    of that of a larger one. kinds: only these (default: all)."""
    folder = pathlib.Path(folder)
    for kind in ("shapes", "bodies"):
        (folder / kind).mkdir(parents=True, exist_ok=True)
    known = {}

    def shape(name):
        if name not in known:
            known[name] = poses.Shape(name)
        return known[name]

    for name in shapes.SHAPES:
        files.write_shape(folder / "shapes" / f"{name}.obj", *shapes.make(name))
    counts, body_counts = ({kind: max(2, round(share * count)) for kind, count in full.items()
                            if kinds is None or kind in kinds} for full in (poses.COUNTS, bodies.COUNTS))
    rows, of = [], sum(counts.values())
    for kind, count in counts.items():
        for number in range(count):
            rows.append(poses.draw(seed, kind, number, shape))
            progress(len(rows), of)
    files.write_poses(folder / "poses.csv", rows)
    for kind, count in body_counts.items():
        for number in range(count):
            body = bodies.make(seed, kind, number)
            files.write_shape(folder / "bodies" / f"{body.name}.obj", *body[1:])
