# SPDX-License-Identifier: MIT OR Apache-2.0
"""The tables of docs/accuracy.md, from forces.csv, figure8.csv and convergence.csv in docs/accuracy: for figures.py."""

import math
import os

import document_tables

SIDES = ["10", "14", "20", "30", "50", "100", "150"]
SIZES = ["500", "1600", "5000", "16 000", "50 000"]
# As in the file: case, mesh, mode.
DEFAULTS = [(case, "exact", "default") for case in ("ball", "globe", "ellipsoid", "lens")] + [
    ("spheres", "fitted", "default"), ("tori", "fitted", "default")]
OTHERS = [(case, mesh, "vertices") for case, mesh, _ in DEFAULTS] + [
    (case, "inscribed", mode) for case in ("spheres", "tori") for mode in ("vertices", "default")]


def percent(text):
    return f"{100 * float(text):.2g}"


def row(cells):
    return "| " + " | ".join(cells) + " |"


def table(head, rows):
    return "\n".join([row(head), row(["---"] * len(head)), *map(row, rows)])


def figure8(rows):
    found = {(line["mode"], line["sides"]): line for line in rows}
    lines = [[f"{mode}, {column}", *(percent(found[mode, sides][column]) for sides in SIDES)]
             for mode in ("paper", "vertices", "default") for column in ("worst", "mean")]
    return table(["sides", *SIDES], lines)


# What docs/accuracy.md says of each case of forces.csv, and in which unit.
FORCES = {"references": "", "aside": "lateral force over what is allowed, ", "steps": "jump at one of 1000 steps, %: ",
          "paths": "net work of closed paths, %: ", "slab": "error to k × volume, %: ",
          "rolled": "tangential over normal force, %: "}
FORCE_LAWS = {"ray length": "the paper's law", "default": "pressure", "accuracy 0.001": "pressure, 0.001"}
# The same of those that have one law.
HARD = {"dense": "net force to that at 0.0005, %: ", "threads": "axial force to that of dense samples, %: ",
        "patch": "stress to its mean, %: "}


def forces(rows, cases, laws):
    """Of each case and its bodies: median, ninety of a hundred, worst; by each law, which has a name in the table."""
    found = {}
    for line in rows:
        if line["case"] in cases:
            found.setdefault((line["case"], line["bodies"]), {})[line["law"]] = line
    lines = []
    for (case, bodies), of_laws in found.items():
        scale = 100 if "%" in cases[case] or bodies.endswith("(part)") else 1
        name = bodies.replace("(part)", "(%)") if bodies.endswith("(part)") else bodies
        cells = [" / ".join(f"{scale * float(of_laws[law][column]):.2g}" for column in ("median", "ninety", "worst"))
                 if law in of_laws else "–" for law in laws]
        lines.append([cases[case] + name, *cells])
    return table(["case", *(f"{name}: median / 90 % / worst" for name in laws.values())], lines)


def order(rows, column):
    """The slope of the error over the edge length, both as logarithms, by least squares, without what is exact."""
    rows = [line for line in rows if float(line[column]) > 0]
    points = [(-0.5 * math.log(float(line["triangles"])), math.log(float(line[column]))) for line in rows]
    x, y = (sum(values) / len(points) for values in zip(*points))
    return sum((a - x) * (b - y) for a, b in points) / sum((a - x) ** 2 for a, _ in points)


def convergence(rows, kinds):
    lines = []
    for kind in kinds:
        own = [line for line in rows if (line["case"], line["mesh"], line["mode"]) == kind]
        for column in ("force_error", "torque_error"):
            if all(line[column] for line in own):
                errors = [percent(line[column]) for line in own]
                name = f"{', '.join(kind[:2])}: {column.removesuffix('_error')}"
                name += "" if kinds is DEFAULTS else f", {kind[2]}"
                lines.append([name, *errors, f"{order(own, column):.2f}", own[1]["rays"]])
    return table(["triangles, about", *SIZES, "order", "rays at 1600"], lines)


def tables(folder):
    """Of docs/accuracy.md, from the folder docs."""
    errors = document_tables.rows(os.path.join(folder, "accuracy", "convergence.csv"))
    measured = document_tables.rows(os.path.join(folder, "accuracy", "forces.csv"))
    return {
        "forces": forces(measured, FORCES, FORCE_LAWS),
        "hard forces": forces(measured, HARD, {"default": "0.01, the default", "accuracy 0.001": "0.001"}),
        "figure8": figure8(document_tables.rows(os.path.join(folder, "accuracy", "figure8.csv"))),
        "convergence": convergence(errors, DEFAULTS),
        "convergence, others": convergence(errors, OTHERS),
    }
