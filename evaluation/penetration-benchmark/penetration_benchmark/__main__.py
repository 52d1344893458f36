# SPDX-License-Identifier: MIT OR Apache-2.0
"""The command line: python -m penetration_benchmark --help"""

import argparse
import csv
import datetime
import os
import pathlib
import sys

# Times are those of one thread.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

from . import bodies, files, libraries, poses, self_contact, simulate, tasks  # noqa: E402, after the number of threads
from .c_library import CLibrary  # noqa: E402
from .generate import generate  # noqa: E402

TASKS = {"detect": (tasks.detect, tasks.DETECT), "measure": (tasks.measure, tasks.MEASURE),
         "free": (tasks.free, tasks.FREE), "intersecting": (tasks.intersecting, tasks.INTERSECTING),
         "simulate": (simulate.simulate, simulate.SIMULATE), "self": (self_contact.self_contact, self_contact.SELF)}
# The kinds of a set that each task takes.
KINDS = {"detect": (*poses.FREE, "apart", "fine"), "measure": (), "free": poses.FREE, "intersecting": poses.FREE,
         "simulate": poses.SCENES, "self": bodies.COUNTS}
ABOUT = ["library", "version", "settings", "documentation", "date", "seed", "share"]


class Progress:
    """One line on a terminal, nothing elsewhere."""

    def __init__(self, name):
        self.name, self.is_shown = name, sys.stderr.isatty()

    def __call__(self, done, of):
        if self.is_shown:
            bar = "#" * (30 * done // of)
            sys.stderr.write(f"\r{self.name:<14}[{bar:<30}] {done}/{of}" + ("\n" if done == of else ""))


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="penetration_benchmark", description="Runs the open benchmark of deep contact and writes CSV files.",
        epilog="Exit status: 0 when written, 1 when a library or file is missing, 2 for a wrong command line.")
    parser.add_argument("out", nargs="?", default="results", help="folder of the CSV files (default: results)")
    parser.add_argument("--libraries", default="all", help="names, with commas between; the first is what times are "
                        f"compared with (default: all that are installed of {', '.join(libraries.KNOWN)})")
    parser.add_argument("--c-library", action="append", default=[], metavar="FILE",
                        help="a shared library behind c/penetration.h; may be repeated")
    parser.add_argument("--python-library", action="append", default=[], metavar="MODULE:CLASS",
                        help="a Library of your own; may be repeated")
    parser.add_argument("--tasks", default=",".join(TASKS), help=f"of {', '.join(TASKS)} (default: all)")
    parser.add_argument("--set", default="", metavar="FOLDER", help="shapes and poses (default: generated in OUT/set)")
    parser.add_argument("--seed", type=int, default=1, help="of what is generated (default: 1)")
    parser.add_argument("--share", type=float, default=1.0, help="of the full number of poses (default: 1)")
    parser.add_argument("--generate-only", action="store_true", help="write the set and no results")
    return parser, parser.parse_args(arguments)


def open_libraries(options, tells=True):
    is_all = options.libraries == "all"
    names = list(libraries.KNOWN) if is_all else [name for name in options.libraries.split(",") if name]
    opened = []
    for name in names:
        try:
            opened.append(libraries.make(name))
        except (ImportError, OSError, KeyError) as error:  # KeyError: PENETRATION_BUILD is not set
            if not is_all:
                raise
            if tells:
                print(f"{name} is left out: {error!r}", file=sys.stderr)
    opened += [CLibrary(path, pathlib.Path(path).stem) for path in options.c_library]
    for path in options.python_library:
        module, kind = path.split(":")
        opened.append(getattr(__import__(module, fromlist=[kind]), kind)())
    return opened


def write(path, head, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def main(arguments=None):
    parser, options = parse(arguments)
    chosen = options.tasks.split(",")
    if any(task not in TASKS for task in chosen):
        parser.error(f"the tasks are {', '.join(TASKS)}")
    unknown = [name for name in options.libraries.split(",") if name not in ("", "all", *libraries.KNOWN)]
    if unknown:
        parser.error(f"there is no library '{unknown[0]}'; there are {', '.join(libraries.KNOWN)}")
    if not options.share > 0:
        parser.error(f"a share of {options.share} has no poses; give a number above 0")
    out = pathlib.Path(options.out)
    folder = pathlib.Path(options.set or out / "set")
    if not options.set:
        kinds = {kind for task in chosen for kind in KINDS[task]}
        generate(folder, options.seed, options.share, Progress("poses"), kinds)
    if options.generate_only:
        return
    surfaces = {path.stem: files.read_shape(path) for path in (folder / "shapes").glob("*.obj")}
    # Neighbours in the list have the same shapes, so that what a library keeps of a pair serves the next.
    listed = sorted(files.read_poses(folder / "poses.csv"), key=lambda pose: (pose.pair, pose.id))
    out.mkdir(parents=True, exist_ok=True)
    for task in chosen:
        # Anew, since a library may keep shapes by their names, and those of the next task are others.
        opened = open_libraries(options, tells=task == chosen[0])
        if task == "measure":
            shapes = {path.stem: files.read_shape(path) for path in (files.REFERENCES / "shapes").glob("*.obj")}
            every = max(1, round(1 / options.share))
            given = shapes, files.read_poses(files.REFERENCES / "poses.csv")[::every]
        elif task == "self":
            given = [[files.read_body(path) for path in sorted((folder / "bodies").glob("*.obj"))]]
        else:
            given = surfaces, [pose for pose in listed if pose.kind in KINDS[task]]
        run, head = TASKS[task]
        taking_part = [library for library in opened if task in library.tasks]
        write(out / f"{task}.csv", head, list(run(taking_part, *given, Progress(task))))
    about = [[library.name, library.version, library.settings, library.documentation, str(datetime.date.today()),
              options.seed, options.share] for library in opened]
    write(out / "libraries.csv", ABOUT, about)


if __name__ == "__main__":
    try:
        main()
    except (OSError, ImportError, KeyError, AttributeError) as error:
        sys.exit(f"penetration_benchmark: {error!r}")
