# SPDX-License-Identifier: MIT OR Apache-2.0
"""The task self: where does the shortest way out lead for vertices inside another part of their own body?"""

import itertools
import statistics
import time

import numpy as np

from .library import found
from .shortest import Judge
from .tasks import ROUNDS, Table, clocked, note, number, quantile, refuse

SELF = ["library", "kind", "bodies", "refused", "inside", "missed", "false", "shortest", "length_median",
        "length_ninety", "exits_us", "exits_ratio", "note"]


def kind_of(body):
    return body.name.rsplit("_", 1)[0]


def self_contact(libraries, bodies, progress):
    """Libraries in turns, the second of two calls, median of three rounds, as in the task detect."""
    table = Table()
    for done, body in enumerate(bodies):
        judge = Judge(body)
        truth = Truth(judge)
        loaded, times = [], {}
        for library in libraries:
            cell = table.cell(library.name, kind_of(body))
            cell["poses"] += 1
            try:
                library.load_body(body)
                loaded.append(library)
            except (ValueError, NotImplementedError) as error:
                refuse(cell, error)
        for round_, place in itertools.product(range(ROUNDS), range(len(loaded))):
            # Each in turn is the first.
            library = loaded[(place + round_) % len(loaded)]
            library.exits(body.positions)
            # Calls of milliseconds are interrupted by whatever else runs: the processor's time of all threads.
            answer, taken = clocked(lambda at=library: at.exits(body.positions), time.process_time)
            times.setdefault(library.name, []).append(taken)
            if round_ == 0:
                truth.count(table.cell(library.name, kind_of(body)), found(answer))
        for name, values in times.items():
            cell, own = table.cell(name, kind_of(body)), statistics.median(values)
            cell.setdefault("us", []).append(own)
            if libraries[0].name in times:
                cell.setdefault("ratio", []).append(own / statistics.median(times[libraries[0].name]))
        progress(done + 1, len(bodies))
    for (name, kind), cell in table.cells.items():
        lengths = [number(quantile(cell.get("lengths", []), share)) for share in (0.5, 0.9)]
        timed = [number(statistics.median(cell[key])) if key in cell else "" for key in ("us", "ratio")]
        yield [name, kind, cell["poses"], cell["refused"],
               *(number(cell.get(key)) for key in ("inside", "missed", "false", "shortest")), *lengths, *timed,
               note(cell)]


class Truth:
    """Of each vertex inside another part of its body, the shortest ways out, one for each part that it is in."""

    def __init__(self, judge):
        self.judge, holders = judge, judge.holders()
        self.unsure = {vertex for vertex, held in enumerate(holders) if held is None}
        self.ways = {vertex: [judge.ways_out(judge.positions[vertex], tetrahedron) for tetrahedron in held]
                     for vertex, held in enumerate(holders) if held}

    def count(self, cell, exits):
        """Adds up how many vertices were found, how many exits are as short as the shortest, and how long they are."""
        answers = dict(zip(exits["vertex"].tolist(), exits["point"]))
        is_short = [self.is_shortest(vertex, answers[vertex]) for vertex in self.ways if vertex in answers]
        counts = {"inside": len(self.ways), "missed": len(self.ways) - len(is_short), "shortest": sum(is_short),
                  "false": len(answers.keys() - self.ways.keys() - self.unsure)}
        for key, count in counts.items():
            cell[key] = cell.get(key, 0) + count
        cell.setdefault("lengths", []).extend(
            float(np.linalg.norm(answers[vertex] - self.judge.positions[vertex]) / min(length for length, _ in ways))
            for vertex, ways in self.ways.items() if vertex in answers)

    def is_shortest(self, vertex, point):
        return any(self.judge.is_as_short(self.judge.positions[vertex], point, way) for way in self.ways[vertex])
