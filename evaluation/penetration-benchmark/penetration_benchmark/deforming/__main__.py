# SPDX-License-Identifier: MIT OR Apache-2.0
"""Elastic bodies, each library in its own solver: do they come apart or carry a load, and what does it take?

Usage: python -m penetration_benchmark.deforming [--scan OBJ] [--seed N] [--scenes NAMES] [--libraries NAMES] [CSV]

Bodies of tetrahedra without friction; density 1000 kg/m³, Young's modulus 1e5 Pa, Poisson's ratio 0.4, size 1 m.
  apart   two that start apart and run into one another at 1 m/s
  deep    two that start at rest, a fifth of their size in one another
  loaded  two blocks, or slabs of one layer of elements, squeezed to a part of their height; half of a ball pushed half
          a block deep into it: for half a second, and held for another; five bodies that fall into a soft tray
How bodies lie beside one another is drawn from a seed. Each library has up to three declared stiffnesses, or what it
has in their place; that with which most scenes of seed 1 and the same start end well, at its first time step, runs on
another seed, drawn when all are known.

The judge is `exact`. *Well* ends a pair that is apart, having met, and a load carried with no vertex deeper than 0.01 m
in another body, none below the ground and no element inside out. At the end: `depth` is that of the deepest vertex,
`inverted` counts tetrahedra inside out, `speed` is the fastest node's, and `energy` that of motion and deformation by
the benchmark's solid. A pair that starts apart starts with its motion, one that starts deep with none, so that what it
ends with came from the contact. `seconds` is the processor's time, at most 240; `parted_after` that until the bodies
were first apart, having met."""

import argparse
import contextlib
import csv
import importlib.util
import itertools
import os
import secrets
import sys
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402, after the number of threads

from ..__main__ import Progress  # noqa: E402
from .scenes import GAP, scenes  # noqa: E402
from .solid import Solid  # noqa: E402
from .solvers import FRAME, LIBRARIES  # noqa: E402

TUNED_SEED = 1
STARTS = ("apart", "deep", "loaded")
MOST_DEPTH = 0.01
# Of the processor, then a run is given up.
MOST_SECONDS = 240
HEAD = ["phase", "scene", "start", "tetrahedra", "library", "version", "stiffness", "time_step", "outcome", "depth",
        "inverted", "speed", "energy", "seconds", "parted_after"]


def run(library, scene, stiffness, time_step):
    """The outcome and what follows it."""
    start, solid, judged = time.process_time(), Solid(scene), 0.0
    solver, has_met, parted_after = library(scene, stiffness, time_step), scene.start == "deep", None
    before = solver.x
    try:
        for _ in range(round(scene.seconds / FRAME)):
            before = solver.x.copy()
            solver.advance()
            if not np.isfinite(solver.x).all():
                raise FloatingPointError
            if scene.is_pair:
                began = time.process_time()
                is_near = near(scene, solver.x)
                is_apart = scene.is_apart(scene.parts(solver.x))
                has_met = has_met or not is_apart or is_near
                if has_met and is_apart and not is_near and parted_after is None:
                    parted_after = began - start - judged
                judged += time.process_time() - began
            if time.process_time() - start - judged > MOST_SECONDS:
                return ["unfinished", "", "", "", "", f"{MOST_SECONDS}", ""]
    except (FloatingPointError, RuntimeError):
        return ["exploded", "", "", "", "", f"{time.process_time() - start - judged:.3g}", ""]
    spent, x = time.process_time() - start - judged, solver.x
    speeds = np.linalg.norm(x - before, axis=1) / FRAME
    depth, inverted = scene.depth(x), int((np.linalg.det(solid.gradients(x)) <= 0).sum())
    if scene.is_pair:
        is_apart = scene.is_apart(scene.parts(x))
        outcome = ("parted" if has_met else "never met") if is_apart else "stuck"
    else:
        has_fallen = x[:, 0].min() < scene.rest[:, 0].min() - MOST_DEPTH
        outcome = "not carried" if has_fallen or depth > MOST_DEPTH or inverted else "carried"
    energy = (solid.mass * speeds ** 2).sum() / 2 + solid.energy(x) - solid.energy(scene.rest)
    return [outcome, f"{depth:.3g}", inverted, f"{speeds.max():.3g}", f"{energy:.4g}", f"{spent:.3g}",
            "" if parted_after is None else f"{parted_after:.3g}"]


def near(scene, x):
    """Whether the boxes are as near as a bouncing pair's are."""
    first, second = scene.parts(x)
    return second[:, 0].min() - first[:, 0].max() < 0.2 * GAP


def measure(phase, drawn, runs, progress):
    """Rows of all scenes; runs: of each library and start the stiffnesses, and of each library the time steps."""
    for done, scene in enumerate(drawn):
        for library, (stiffnesses, time_steps) in runs.items():
            what = [phase, scene.name, scene.start, len(scene.tetrahedra), library.name, library.version()]
            for stiffness, time_step in itertools.product(stiffnesses[scene.start], time_steps):
                given = [*what, stiffness, time_step]
                if scene.start == "deep" and not library.may_overlap:
                    yield [*given, "does not apply", *6 * [""]]
                else:
                    yield [*given, *run(library, scene, library.stiffnesses[stiffness], time_step)]
        progress(done + 1, len(drawn))


def best_stiffness(library, start, rows):
    """That with which most scenes of this start end well; of equals the first declared."""
    well = dict.fromkeys(library.stiffnesses, 0)
    for row in (dict(zip(HEAD, row)) for row in rows):
        if (row["library"], row["start"]) == (library.name, start):
            well[row["stiffness"]] += row["outcome"] in ("parted", "carried")
    return max(well, key=well.get)


def is_installed(library):
    build = os.path.join(os.environ.get("PENETRATION_BUILD", ""), "bullet_soft.so")
    return importlib.util.find_spec(library.module) if library.module else os.path.exists(build)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", nargs="?", default="-", help="where the figures go (default: printed)")
    parser.add_argument("--scenes", default="", metavar="NAMES", help="with / between (default: all)")
    parser.add_argument("--libraries", default="", metavar="NAMES",
                        help="with / between (default: all that are installed of "
                        f"{'/'.join(library.name for library in LIBRARIES)})")
    parser.add_argument("--scan", default="", help="a closed surface, .obj, of which one more pair is made")
    parser.add_argument("--seed", type=int, help="of the scenes that count (default: drawn once stiffnesses are known)")
    options = parser.parse_args()
    names = options.libraries.split("/") if options.libraries else [library.name for library in LIBRARIES]
    taking_part = [library for library in LIBRARIES if library.name in names and is_installed(library)]
    for name in set(names) - {library.name for library in taking_part}:
        print(f"{name} is left out: not installed, or there is no such library; see --help", file=sys.stderr)

    def chosen(seed):
        listed = list(scenes(seed, options.scan))
        return [scene for scene in listed if not options.scenes or scene.name in options.scenes.split("/")]

    with contextlib.ExitStack() as files:
        out = sys.stdout if options.csv == "-" else files.enter_context(
            open(options.csv, "w", newline="", encoding="utf-8"))
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(HEAD)
        tuned = {library: (dict.fromkeys(STARTS, library.stiffnesses), library.time_steps[:1])
                 for library in taking_part if len(library.stiffnesses) > 1}
        rows = list(measure("tuned", chosen(TUNED_SEED), tuned, Progress("tuning")))
        writer.writerows(rows)
        seed = secrets.randbelow(10**6) if options.seed is None else options.seed
        runs = {library: ({start: [best_stiffness(library, start, rows)] for start in STARTS}, library.time_steps)
                for library in taking_part}
        for row in measure(f"seed {seed}", chosen(seed), runs, Progress("scenes")):
            writer.writerow(row)
            out.flush()


if __name__ == "__main__":
    main()
