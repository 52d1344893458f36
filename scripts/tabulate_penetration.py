# SPDX-License-Identifier: MIT OR Apache-2.0
"""The tables of docs/penetration.md, from the CSV files in docs/penetration: for figures.py."""

import os
import random
import statistics

import document_tables

KINDS = ["shallow", "deep", "concentric", "coincident", "contained", "edges", "apart"]
FREE_KINDS = KINDS[:-1]
SELF_KINDS = ["ring", "eight", "pinch", "fold"]
# Where times are compared: kind and shapes.
TIMES = [("shallow", "convex"), ("deep", "convex"), ("deep", "concave"), ("fine", "convex"), ("fine", "concave")]
FORCES = [("random", "convex", "overlap_volume"), ("random", "concave", "overlap_volume"),
          ("random", "convex", "hydroelastic"), ("random", "concave", "hydroelastic"),
          ("pressed", "concave", "hydroelastic")]
# Ways out are compared among libraries that free this part.
NEARLY_ALL = 0.99
# Scenes of simulate, by shapes, and where depths at rest are taken.
SCENES = [(scene, shapes) for scene in ("drop", "impact", "part") for shapes in ("convex", "concave")]
REST_STEP = "1/60"
JUDGES = {"overlap_volume": "even pressure", "hydroelastic": "hydroelastic"}


def table(head, rows):
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [head, ["---"] * len(head), *rows])


class Column:
    """Cells of one column: their text, and what the best of them is known by (less is better)."""

    def __init__(self, cells):
        ranks = [rank for _, rank in cells.values() if rank is not None]
        best = min(ranks, default=None)
        self.texts = {library: f"**{text}**" if rank is not None and rank == best else text
                      for library, (text, rank) in cells.items()}


def ranked(head, libraries, columns, order):
    """The rows in the order of one number of each library, less being better; those without it last."""
    last = float("inf")
    known = sorted(libraries, key=lambda library: last if order.get(library) is None else order[library])
    columns = [Column(column) for column in columns]
    return table(head, [[library, *(column.texts[library] for column in columns)] for library in known])


def total(rows, column):
    values = [int(row[column]) for row in rows if row[column]]
    return sum(values) if values else None


def only(rows, **wanted):
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def names(rows):
    return list(dict.fromkeys(row["library"] for row in rows))


def share(rows, column):
    """(text, rank) of a part of all poses, in per cent; those that a library refuses are not among them."""
    done, of = total(rows, column), sum(int(row["poses"]) - int(row["refused"]) for row in rows)
    if done is None or not of:
        return "–", None
    text = f"{100 * done / of:.4g}" if done != of else "100"
    refused = total(rows, "refused")
    return text + (f" of {of}" if refused else ""), -done / of


def libraries_table(rows):
    lines = []
    for row in rows:
        link = f"[authors]({row['documentation']})" if row["documentation"].startswith("http") else "[here](options.md)"
        lines.append([row["library"], row["version"], row["settings"], link])
    return table(["library", "version", "settings", "documentation"], lines)


def verdicts(rows):
    rows = [row for row in rows if row["verdicts_right"]]
    libraries = names(rows)
    columns = [{library: share(only(rows, library=library, kind=kind), "verdicts_right") for library in libraries}
               for kind in KINDS]
    everything = {library: share([row for row in rows if row["library"] == library and row["kind"] in KINDS],
                                 "verdicts_right") for library in libraries}
    order = {library: rank for library, (_, rank) in everything.items()}
    return ranked(["library", "all", *KINDS], libraries, [everything, *columns], order)


def vertices(rows):
    libraries = [name for name in names(rows) if total(only(rows, library=name), "inside") is not None]
    wrong, order = {}, {}
    for library in libraries:
        own = [row for row in only(rows, library=library) if row["inside"]]
        missed, false, inside = (total(own, column) for column in ("missed", "false", "inside"))
        order[library] = (missed + false) / inside
        wrong[library] = [(f"{missed} of {inside}", missed / inside), (str(false), false)]
    columns = [{library: wrong[library][i] for library in libraries} for i in (0, 1)]
    for place in TIMES:
        columns.append({library: ratio(rows, library, place, "inside") for library in libraries})
    head = ["library", "inside, missed", "outside, called inside", *map(", ".join, TIMES)]
    return ranked(head, libraries, columns, order)


def ratio(rows, library, place, query):
    found = [row for row in only(rows, library=library, kind=place[0], shapes=place[1]) if row[query + "_ratio"]]
    if not found:
        return "–", None
    return f"{float(found[0][query + '_ratio']):.2g} ({float(found[0][query + '_us']):.3g} µs)", float(
        found[0][query + "_ratio"])


def times(rows):
    libraries = [name for name in names(rows) if any(row["contacts_us"] for row in only(rows, library=name))]
    columns = [{library: ratio(rows, library, place, "contacts") for library in libraries} for place in TIMES]
    return ranked(["library", *map(", ".join, TIMES)], libraries, columns,
                  {library: columns[2][library][1] for library in libraries})


def forces(rows, kinds, texts, head):
    libraries = [name for name in names(rows) if any(row["median"] for row in only(rows, library=name))]
    columns = []
    for kind, shapes, judge in kinds:
        cells = {}
        for library in libraries:
            row = only(rows, library=library, kind=kind, shapes=shapes, judge=judge)[0]
            cells[library] = texts(row) if row["median"] else ("–", None)
        columns.append(cells)
    titles = [f"{kind}, {shapes}, to {JUDGES[judge]}" for kind, shapes, judge in kinds]
    return ranked([head, *titles], libraries, columns, {library: columns[-2][library][1] for library in libraries})


def direction(row):
    silent = f" ({row['silent']} of {row['poses']} silent)" if row["silent"] != "0" else ""
    refused = f" ({row['refused']} of {row['poses']} refused)" if row["refused"] != "0" else ""
    return " / ".join(f"{float(row[key]):.2g}" for key in ("median", "ninety", "worst")) + silent + refused, float(
        row["median"])


def size(row):
    return " / ".join(f"{float(row[key]):.3g}" for key in ("size_median", "size_ninety")), float(row["size_median"])


def free(rows):
    rows = [row for row in rows if not row["refused"] == row["poses"]]
    libraries = [name for name in names(rows)]
    everything = {library: share(only(rows, library=library), "freed") for library in libraries}
    poses = {library: (str(total(only(rows, library=library), "poses")), None) for library in libraries}
    nearly = {library: (f"{abs(100 * share(only(rows, library=library), 'nearly')[1]):.2g}", None) for library in libraries}
    columns = [poses, everything, nearly]
    columns += [{library: share(only(rows, library=library, kind=kind), "freed") for library in libraries}
                for kind in FREE_KINDS]
    return ranked(["library", "poses", "all", "nearly", *FREE_KINDS], libraries, columns,
                  {library: rank for library, (_, rank) in everything.items()})


def shapes(rows):
    """Per cent freed, steps and way by kind of shapes, where a library frees any; best among those that free nearly all."""
    libraries, columns = [name for name in names(rows) if total(only(rows, library=name), "freed")], []
    for kind, group in (("shallow", "convex"), ("shallow", "concave"), ("deep", "convex"), ("deep", "concave")):
        cells = {}
        for library in libraries:
            found = [row for row in only(rows, library=library, kind=kind, shapes=group) if row["median_steps"]]
            cells[library] = ("–", None)
            if found:
                row = found[0]
                text, rank = share(found, "freed")
                texts = [text.split()[0], row["median_steps"], row["ninety_steps"], f"{float(row['median_way']):.2g}"]
                cells[library] = " / ".join(texts), float(row["median_way"]) if -rank >= NEARLY_ALL else None
        columns.append(cells)
    head = ["library", "shallow, convex", "shallow, concave", "deep, convex", "deep, concave"]
    return ranked(head, libraries, columns, {name: share(only(rows, library=name), "freed")[1] for name in libraries})


def kept(rows, is_deep):
    """Rows of one start, of libraries that it does not exclude."""
    return [row for row in rows if (row["scene"] == "part") == is_deep and row["refused"] != row["scenes"]]


def simulated(rows, is_deep):
    """Per cent of the scenes that end well, by scene and shapes."""
    rows = kept(rows, is_deep)
    libraries = names(rows)
    runs = {library: [{"scene": pose, "outcome": "done" if pose in row["ended_well"].split() else "other"}
                      for row in only(rows, library=library) for pose in row["asked"].split()] for library in libraries}
    everything = {library: interval(runs[library]) for library in libraries}
    scenes = [(scene, shapes) for scene, shapes in SCENES if (scene == "part") == is_deep]
    columns = [{library: part_done(only(rows, library=library, scene=scene, shapes=shapes)) for library in libraries}
               for scene, shapes in scenes]
    return ranked(["library", "ended well (95 %)", *map(", ".join, scenes)], libraries, [everything, *columns],
                  {library: rank for library, (_, rank) in everything.items()})


def simulated_steps(rows, is_deep):
    """The same by time step; then what is gained in energy, and how deep bodies rest."""
    rows = kept(rows, is_deep)
    libraries, steps = names(rows), list(dict.fromkeys(row["time_step"] for row in rows))
    columns = [{library: part_done(only(rows, library=library, time_step=step)) for library in libraries}
               for step in steps]
    exploded = {library: total(only(rows, library=library), "exploded") for library in libraries}
    columns.append({library: (str(count), None) for library, count in exploded.items()})
    gained = {library: max(float(row["gained_worst"]) for row in only(rows, library=library) if row["gained_worst"])
              for library in libraries}
    columns.append({library: (f"{100 * most:.3g}", None) for library, most in gained.items()})
    for shapes in () if is_deep else ("convex", "concave"):
        found = {library: only(rows, library=library, scene="drop", shapes=shapes, time_step=REST_STEP)[0]
                 for library in libraries}
        columns.append({library: (f"{100 * float(row['depth_median']):.2g}" if row["depth_median"] else "–", None)
                        for library, row in found.items()})
    head = ["library", *steps, "exploded", "energy gained", *["depth at rest, convex", "depth at rest, concave"] * (not is_deep)]
    return ranked(head, libraries, columns, {library: part_done(only(rows, library=library))[1] for library in libraries})


def part_done(rows):
    return share([{**row, "poses": row["scenes"]} for row in rows], "done")


def interval(rows):
    """(text, rank) of the runs that end well, in per cent, and what 95 % of 2000 draws of scenes instead of these have."""
    if not rows or all(row["outcome"] == "does not apply" for row in rows):
        return ("does not apply" if rows else "–"), None
    scenes = {}
    for row in rows:
        scenes.setdefault(row["scene"], []).append(row["outcome"] == "done")
    part = lambda drawn: sum(map(sum, drawn)) / sum(map(len, drawn))  # noqa: E731
    draw, listed = random.Random(1).choices, list(scenes.values())
    drawn = sorted(part(draw(listed, k=len(listed))) for _ in range(2000))
    return f"{100 * part(listed):.0f} ({100 * drawn[50]:.0f} to {100 * drawn[1949]:.0f})", -part(listed)


def solvers(rows, is_deep):
    """Scenes that end well with each library in its own solver, of a start apart or deep."""
    rows = [row for row in rows if row["phase"] != "tuned" and (row["kind"] == "part") == is_deep]
    libraries, steps = names(rows), ("1/60", "1/240")
    applies = [row for row in rows if row["outcome"] != "does not apply"]
    own = {library: only(rows, library=library) for library in libraries}

    def part(library, **wanted):
        found = only(applies, library=library, **wanted)
        well = len(only(found, outcome="done"))
        return (f"{well} of {len(found)}", -well / len(found)) if found else ("–", None)

    def its_step(library):
        found = [row["time_step"] for row in only(applies, library=library) if row["time_step"] not in steps]
        if not found:
            return "–", None
        text, rank = part(library, time_step=found[0])
        return f"{text}, {found[0]}", rank

    columns = [{library: (own[library][0]["stiffness"], None) for library in libraries},
               {library: interval(own[library]) for library in libraries}]
    kinds = [("part", shapes) for shapes in ("convex", "concave")] if is_deep else SCENES[:4]
    columns += [{library: part(library, kind=kind, shapes=shapes) for library in libraries} for kind, shapes in kinds]
    columns += [{library: part(library, time_step=step) for library in libraries} for step in steps]
    columns.append({library: its_step(library) for library in libraries})
    depths, costs = {}, {}
    for library in libraries:
        found = only(applies, library=library)
        kept = [row for row in found if row["depth"] and (row["kind"] == "drop" or is_deep)]
        deep = [100 * float(row["depth"]) for row in kept if not is_deep or row["outcome"] == "stuck"]
        depths[library] = (f"{statistics.median(deep):.2g} / {max(deep):.2g}" if deep else "–"), None
        spent = [float(row["cost"]) for row in found if row["time_step"] == "1/60"]
        costs[library] = (f"{statistics.median(spent):.2g}" if spent else "–"), None
    thrown = {library: (str(len(only(applies, library=library, outcome="thrown"))), None) for library in libraries}
    columns += [depths, thrown, costs] if is_deep else [depths, costs]
    head = ["library", "stiffness", "ended well (95 %)", *map(", ".join, kinds), *steps, "own step",
            "depth left, stuck" if is_deep else "depth, drop", *["thrown"] * is_deep, "seconds a second"]
    return ranked(head, libraries, columns, {library: columns[1][library][1] for library in libraries})


def solvers_by_seed(rows):
    """Of three libraries, on several seeds: runs that ended well, in per cent, at the steps that all have."""
    rows = [row for row in rows if row["phase"] != "tuned" and row["time_step"] in ("1/60", "1/240")]
    seeds = list(dict.fromkeys(row["phase"].removeprefix("seed ") for row in rows))
    lines = []
    for library in ("raycontact", "MuJoCo", "Bullet"):
        for start in ("apart", "deep"):
            own = [row for row in only(rows, library=library) if (row["kind"] == "part") == (start == "deep")]
            parts = [own] + [only(own, phase=f"seed {seed}") for seed in seeds]
            lines.append([library, start, *(f"{100 * len(only(part, outcome='done')) / len(part):.0f}" for part in parts)])
    return table(["library", "start", "all", *seeds], lines)


def intersecting(rows):
    lines = [[row["kind"], row["poses"], row["told_intersecting"], f"{float(row['median_share']):.2g}",
              f"{float(row['largest_share']):.2g}"] for row in rows]
    return table(["kind", "poses", "told to intersect", "median part of the way", "largest"], lines)


def done(rows, column):
    """(text, rank) of a part of the vertices inside, in per cent."""
    inside = total(rows, "inside")
    found = total(rows, column) / inside
    return f"{100 * found:.4g}", -found


def self_contact(rows):
    rows = [row for row in rows if row["inside"]]
    libraries = names(rows)
    own = {library: only(rows, library=library) for library in libraries}
    missed = {library: (f"{total(own[library], 'missed')} of {total(own[library], 'inside')}",
                        total(own[library], "missed")) for library in libraries}
    false = {library: (str(total(own[library], "false")), total(own[library], "false")) for library in libraries}
    columns = [missed, false, {library: done(own[library], "shortest") for library in libraries}]
    columns += [{library: done(only(rows, library=library, kind=kind), "shortest") for library in libraries}
                for kind in SELF_KINDS]
    head = ["library", "inside, missed", "outside, called inside", "shortest, all", *SELF_KINDS]
    return ranked(head, libraries, columns, {library: rank for library, (_, rank) in columns[2].items()})


def self_times(rows):
    """By kind of body: times, best among those whose exits are nearly all shortest, and how long the ways out are in
    shortest ones, median and 90 %."""
    rows = [row for row in rows if row["inside"]]
    libraries = names(rows)
    columns = []
    for kind in SELF_KINDS:
        cells = {}
        for row in only(rows, kind=kind):
            text = f"{float(row['exits_ratio']):.2g} ({float(row['exits_us']):.3g} µs)"
            is_right = int(row["shortest"]) >= 0.95 * int(row["inside"])
            cells[row["library"]] = text, float(row["exits_ratio"]) if is_right else None
        columns.append(cells)
    for kind in SELF_KINDS:
        columns.append({row["library"]: (f"{float(row['length_median']):.3g} / {float(row['length_ninety']):.3g}",
                                         float(row["length_median"])) for row in only(rows, kind=kind)})
    head = ["library", *(f"time, {kind}" for kind in SELF_KINDS), *(f"length, {kind}" for kind in SELF_KINDS)]
    return ranked(head, libraries, columns, {library: columns[0][library][1] for library in libraries})


def read(folder, name):
    return document_tables.rows(os.path.join(folder, "penetration", f"{name}.csv"))


def tables(folder):
    """Of docs/penetration.md, from the folder docs."""
    detected, measured, freed = (read(folder, name) for name in ("detect", "measure", "free"))
    about = read(folder, "libraries")
    return {
        "libraries": libraries_table(about),
        "verdicts": verdicts(detected),
        "vertices": vertices(detected),
        "times": times(detected),
        "directions": forces(measured, FORCES, direction, "library"),
        "sizes": forces(measured, FORCES[:4], size, "library"),
        "free": free(freed),
        "ways": shapes(freed),
        "simulate, apart": simulated(read(folder, "simulate"), False),
        "simulate, deep": simulated(read(folder, "simulate"), True),
        "simulate_steps, apart": simulated_steps(read(folder, "simulate"), False),
        "simulate_steps, deep": simulated_steps(read(folder, "simulate"), True),
        "solvers, apart": solvers(read(folder, "solvers"), False),
        "solvers, deep": solvers(read(folder, "solvers"), True),
        "solvers, seeds": solvers_by_seed(read(folder, "solvers") + read(folder, "solvers_seeds")),
        "intersecting": intersecting(read(folder, "intersecting")),
        "self": self_contact(read(folder, "self")),
        "self_times": self_times(read(folder, "self")),
        "date": f"Run on {about[0]['date']}, seed {about[0]['seed']}, "
                f"{100 * float(about[0]['share']):.3g} % of the full number of poses.",
    }
