# SPDX-License-Identifier: MIT OR Apache-2.0
"""The tasks: each gives rows of its CSV file, one for each library, kind of pose and kind of shapes."""

import copy
import csv
import itertools
import statistics
import time

import numpy as np

from . import exact, motion
from .files import REFERENCES, placed
from .library import Contacts, found

DETECT = ["library", "kind", "shapes", "poses", "refused", "inside", "missed", "false", "verdicts_right", "inside_us",
          "inside_ratio", "contacts_us", "contacts_ratio", "note"]
MEASURE = ["library", "kind", "shapes", "judge", "poses", "refused", "silent", "median", "ninety", "worst",
           "size_median", "size_ninety", "note"]
FREE = ["library", "kind", "shapes", "poses", "refused", "freed", "nearly", "stuck", "exploded", "median_steps",
        "ninety_steps", "median_way", "note"]
INTERSECTING = ["library", "kind", "poses", "told_intersecting", "median_share", "largest_share"]
# Timed rounds of each pose.
ROUNDS = 3
# Microseconds above which one call is enough.
SLOW = 5e4
# A body is nearly free when a shift of this part of its size, along one of 26 directions, makes it free.
NEARLY = 0.02


def group(surfaces):
    return "convex" if all(surface.is_convex for surface in surfaces) else "concave"


def quantile(values, share):
    return sorted(values)[min(int(share * len(values)), len(values) - 1)] if values else None


def number(value):
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


class Table:
    """Collects what each library did at each pose, by library and kind."""

    def __init__(self):
        self.cells = {}

    def cell(self, *key):
        return self.cells.setdefault(key, {"poses": 0, "refused": 0, "notes": []})


def refuse(cell, error):
    cell["refused"] += 1
    if str(error) not in cell["notes"]:
        cell["notes"].append(str(error))


def note(cell):
    return "; ".join(cell["notes"])


def clocked(call, clock=time.perf_counter):
    """What a library answers, after the clock has stopped, and microseconds."""
    start = clock()
    answer = call()
    end = clock()
    return answer, 1e6 * (end - start)


def ask(library, query, placements, positions):
    """The answer, and the microseconds of moving and asking."""
    _, moving = clocked(lambda: library.move(placements, positions))
    answer, asking = clocked(getattr(library, query))
    if query == "contacts":
        answer = found(answer)
    return answer, moving + asking


def count(cell, query, answer, truth, is_apart):
    """Adds up what was right and wrong."""
    if query == "contacts":
        cell["verdicts_right"] = cell.get("verdicts_right", 0) + int((len(answer) > 0) != is_apart)
        return
    marks = [(t > 0, t != 0, a) for t, a in zip(truth, answer)]
    for key, number_ in (("inside", sum((t & s).sum() for t, s, _ in marks)),
                         ("missed", sum((t & s & ~a).sum() for t, s, a in marks)),
                         ("false", sum((~t & s & a).sum() for t, s, a in marks))):
        cell[key] = cell.get(key, 0) + int(number_)


def detect(libraries, surfaces, poses, progress):
    """Which vertices are inside, whether bodies overlap at all, and the time of both, libraries in turns."""
    table = Table()
    for done, pose in enumerate(poses):
        pair = [surfaces[name] for name in pose.pair]
        placements = pose.placements()
        positions = tuple(placed(s, p) for s, p in zip(pair, placements))
        truth = [exact.classify(positions[i], positions[1 - i], pair[1 - i].triangles) for i in (0, 1)]
        is_apart = exact.Apart([s.triangles for s in pair])(positions)
        times = {}
        loaded = []
        for library in libraries:
            cell = table.cell(library.name, pose.kind, group(pair))
            cell["poses"] += 1
            try:
                library.load(*pair)
                loaded.append(library)
            except ValueError as error:
                refuse(cell, error)
        for round_, place in itertools.product(range(ROUNDS), range(len(loaded))):
            # Nobody is always asked after the same other.
            library = loaded[(place + round_ + done) % len(loaded)]
            cell = table.cell(library.name, pose.kind, group(pair))
            for query in ("inside", "contacts"):
                if round_ and max(times.get((library.name, query), [0])) > SLOW:
                    continue
                try:
                    answer, taken = ask(library, query, placements, positions)
                    # Asked again at once, so that no other library's data are in the processor's caches.
                    if taken < SLOW:
                        _, taken = ask(library, query, placements, positions)
                except NotImplementedError as error:
                    if str(error) not in cell["notes"]:
                        cell["notes"].append(str(error))
                    continue
                times.setdefault((library.name, query), []).append(taken)
                if round_ == 0:
                    count(cell, query, answer, truth, is_apart)
        for (name, query), values in times.items():
            cell, own = table.cell(name, pose.kind, group(pair)), statistics.median(values)
            cell.setdefault(query + "_us", []).append(own)
            if (libraries[0].name, query) in times:
                cell.setdefault(query + "_ratio", []).append(
                    own / statistics.median(times[libraries[0].name, query]))
        progress(done + 1, len(poses))
    for (name, kind, shapes), cell in table.cells.items():
        timed = [number(statistics.median(cell[key])) if key in cell else ""
                 for key in ("inside_us", "inside_ratio", "contacts_us", "contacts_ratio")]
        yield [name, kind, shapes, cell["poses"], cell["refused"],
               *(number(cell.get(key)) for key in ("inside", "missed", "false", "verdicts_right")), *timed, note(cell)]


def read_judges():
    """Of each pose of the references: the force of an even pressure (minus the gradient of the overlap volume) and that
    of hydroelastic contact."""
    judges = {}
    for name in ("overlap_volume", "hydroelastic"):
        with open(REFERENCES / f"{name}.csv", newline="", encoding="utf-8") as file:
            judges[name] = {int(row["id"]): np.array([float(row["force_" + axis]) for axis in "xyz"])
                            for row in csv.DictReader(file)}
    return judges


def measure(libraries, surfaces, poses, progress):
    """Net forces against those of two judges. An even pressure says nothing of a body between two walls."""
    judges, table = read_judges(), Table()
    for done, pose in enumerate(poses):
        pair = [surfaces[name] for name in pose.pair]
        placements = pose.placements()
        positions = tuple(placed(s, p) for s, p in zip(pair, placements))
        for library in libraries:
            cells = [(table.cell(library.name, pose.kind, group(pair), judge), judges[judge][pose.id])
                     for judge in judges if pose.kind == "random" or judge == "hydroelastic"]
            try:
                library.load(*pair)
                library.move(placements, positions)
                force = Contacts.force(found(library.contacts()))
            except (ValueError, NotImplementedError) as error:
                for cell, _ in cells:
                    cell["poses"] += 1
                    refuse(cell, error)
                continue
            for cell, judge in cells:
                cell["poses"] += 1
                if not np.linalg.norm(force) > 0:
                    cell["silent"] = cell.get("silent", 0) + 1
                    continue
                cell.setdefault("angles", []).append(angle(force, judge))
                cell.setdefault("sizes", []).append(np.log(np.linalg.norm(force) / np.linalg.norm(judge)))
        progress(done + 1, len(poses))
    # A library's unit of force is its own: one factor for all of its poses that a judge has judged.
    units = {}
    for (name, _, _, judge), cell in table.cells.items():
        units.setdefault((name, judge), []).extend(cell.get("sizes", []))
    for (name, kind, shapes, judge), cell in table.cells.items():
        angles, unit = cell.get("angles", []), statistics.median(units[name, judge] or [0.0])
        factors = [float(np.exp(abs(size - unit))) for size in cell.get("sizes", [])]
        yield [name, kind, shapes, judge, cell["poses"], cell["refused"], cell.get("silent", 0),
               *(number(value) for value in (quantile(angles, 0.5), quantile(angles, 0.9), quantile(angles, 1.0),
                                             quantile(factors, 0.5), quantile(factors, 0.9))), note(cell)]


def angle(a, b):
    """In degrees."""
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)))


def free(libraries, surfaces, poses, progress):
    """How many come apart by the rule of motion.py."""
    table = Table()
    for done, pose in enumerate(poses):
        pair = [surfaces[name] for name in pose.pair]
        # Where the start meets is the same for all.
        start = exact.Apart([s.triangles for s in pair])
        start([placed(s, p) for s, p in zip(pair, pose.placements())])
        for library in libraries:
            cell, apart = table.cell(library.name, pose.kind, group(pair)), copy.copy(start)
            cell["poses"] += 1
            try:
                library.load(*pair)
                outcome, steps, way, bodies = motion.free(library, pair, pose, apart, found)
            except (ValueError, NotImplementedError) as error:
                refuse(cell, error)
                continue
            if outcome == "stuck" and is_nearly_free(bodies, apart):
                outcome = "nearly"
            cell[outcome] = cell.get(outcome, 0) + 1
            if outcome == "freed":
                cell.setdefault("steps", []).append(steps)
                cell.setdefault("ways", []).append(float(way))
        progress(done + 1, len(poses))
    for (name, kind, shapes), cell in table.cells.items():
        steps = cell.get("steps", [])
        outcomes = [cell.get(outcome, 0) for outcome in ("freed", "nearly", "stuck", "exploded")]
        quantiles = quantile(steps, 0.5), quantile(steps, 0.9), quantile(cell.get("ways", []), 0.5)
        yield [name, kind, shapes, cell["poses"], cell["refused"], *outcomes, *map(number, quantiles), note(cell)]


def is_nearly_free(bodies, apart):
    first, second = (body.positions() for body in bodies)
    way = NEARLY * min(body.size for body in bodies)
    directions = [np.array(d) / np.linalg.norm(d) for d in itertools.product((-1, 0, 1), repeat=3) if any(d)]
    return any(apart((first + way * direction, second)) for direction in directions)


def intersecting(libraries, surfaces, poses, progress):
    """What a library that must start without intersections does with a start that has some: whether it tells, and how
    much of a way of a tenth of the size, along the line of centres, its step rule lets the bodies go."""
    table = Table()
    for library in libraries:
        for done, pose in enumerate(poses if hasattr(library, "free_share") else []):
            pair = [surfaces[name] for name in pose.pair]
            placements = pose.placements()
            first, second = (placed(s, p) for s, p in zip(pair, placements))
            between = second.mean(0) - first.mean(0)
            direction = between / np.linalg.norm(between) if np.linalg.norm(between) > 1e-9 else np.array([1.0, 0, 0])
            library.load(*pair)
            library.move(placements, (first, second))
            share, is_told = library.free_share((first, second + 0.1 * direction))
            cell = table.cell(library.name, pose.kind)
            cell["poses"] += 1
            cell["told"] = cell.get("told", 0) + int(is_told)
            cell.setdefault("shares", []).append(float(share))
            progress(done + 1, len(poses))
    for (name, kind), cell in table.cells.items():
        yield [name, kind, cell["poses"], cell["told"], number(statistics.median(cell["shares"])),
               number(max(cell["shares"]))]
