#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws free.svg, simulate.svg, directions.svg and solvers.svg from the CSV files in one folder.

Usage: draw_penetration.py [docs/penetration]

scripts/penetration.sh measures and calls it. Needs matplotlib.
"""

import os

import document_tables
from drawing import draw_in_folder, numpy, plot, save

# Told apart by colour-blind readers too.
OUTCOMES = {"freed": ("apart", "#1b6ab3"), "nearly": ("apart after a shift of 2 % of the size", "#8fbce6"),
            "stuck": ("stuck after 100 steps", "#ee8822"), "exploded": ("exploded", "#c02050"),
            "refused": ("shapes refused", "#cccccc")}
ENDS = {"done": ("at rest, kept out, apart", "#1b6ab3"), "restless": ("never at rest", "#8fbce6"),
        "sunk": ("sunk in or through", "#ee8822"), "stuck": ("still overlapping", "#f6c58a"),
        "exploded": ("exploded", "#c02050"), "refused": ("shapes refused", "#cccccc")}
SCENES = {"drop": "drop: at rest", "impact": "impact: kept out", "part": "part: apart"}
# Libraries in their own solvers: colour and sign.
SOLVERS = {"raycontact": ("#1b6ab3", "o"), "IPC Toolkit": ("#555555", "s"), "MuJoCo": ("#ee8822", "^"),
           "MuJoCo with sdf": ("#ee8822", "v"), "Bullet": ("#c02050", "D"), "Bullet with convex parts": ("#c02050", "P"),
           "Drake": ("#228833", "X")}
JUDGES = {"overlap_volume": ("even pressure", "#555555", "s"), "hydroelastic": ("hydroelastic contact", "#1b6ab3", "o")}


def read(folder, name):
    return document_tables.rows(os.path.join(folder, name))


def add_up(rows, outcomes):
    """Of each library that is not refused everywhere."""
    sums = {}
    for row in rows:
        own = sums.setdefault(row["library"], dict.fromkeys(outcomes, 0))
        for outcome in outcomes:
            own[outcome] += int(row[outcome])
    return {name: own for name, own in sums.items() if own["refused"] < sum(own.values())}


def draw_bars(axes, names, sums, outcomes):
    """Per cent of each outcome, one bar for each library. Returns what stands for each."""
    left, bars = [0.0] * len(names), {}
    for outcome, (label, colour) in outcomes.items():
        width = [100 * sums[name][outcome] / sum(sums[name].values()) for name in names]
        if any(width):
            bars[label] = axes.barh(names, width, left=left, color=colour, height=0.7)
            left = [a + b for a, b in zip(left, width)]
    axes.set_xlim(0, 100)
    return bars


def draw_free(folder):
    sums = add_up(read(folder, "free.csv"), OUTCOMES)
    names = sorted(sums, key=lambda name: sums[name]["freed"] / sum(sums[name].values()))
    figure, axes = plot.subplots(figsize=(7.2, 0.36 * len(names) + 0.8), layout="constrained")
    bars = draw_bars(axes, names, sums, OUTCOMES)
    axes.set_xlabel("% of the overlapping poses")
    figure.legend(bars.values(), bars, fontsize=8, ncols=3, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    save(figure, folder, "free.svg", bbox_inches="tight")


def draw_simulate(folder):
    rows = read(folder, "simulate.csv")
    # In the order of starts apart alone: deep ones are another question.
    every = add_up([row for row in rows if row["scene"] != "part"], ENDS)
    names = sorted(every, key=lambda name: every[name]["done"] / sum(every[name].values()))
    figure, panels = plot.subplots(1, 3, figsize=(8.4, 0.3 * len(names) + 1.0), sharey=True, layout="constrained")
    bars = {}
    for axes, (scene, title) in zip(panels, SCENES.items()):
        bars |= draw_bars(axes, names, add_up([row for row in rows if row["scene"] == scene], ENDS), ENDS)
        axes.set(title=title, xlabel="% of the scenes")
    ordered = [label for label, _ in ENDS.values() if label in bars]
    figure.legend([bars[label] for label in ordered], ordered, fontsize=8, ncols=3, loc="lower center",
                  bbox_to_anchor=(0.5, 1.0))
    save(figure, folder, "simulate.svg", bbox_inches="tight")


def draw_directions(folder):
    rows = [row for row in read(folder, "measure.csv") if row["kind"] == "random" and row["median"]]
    names = list(dict.fromkeys(row["library"] for row in rows))[::-1]
    figure, panels = plot.subplots(1, 2, figsize=(8.4, 0.42 * len(names) + 1.0), sharex=True, sharey=True, layout="constrained")
    for axes, shapes in zip(panels, ("convex", "concave")):
        for offset, (judge, (label, colour, marker)) in zip((0.15, -0.15), JUDGES.items()):
            own = {row["library"]: row for row in rows if (row["shapes"], row["judge"]) == (shapes, judge)}
            places = [names.index(name) + offset for name in own]
            ends = [[float(row[key]) for row in own.values()] for key in ("median", "ninety")]
            axes.hlines(places, *ends, color=colour, linewidth=1.5)
            axes.plot(ends[0], places, marker, color=colour, markersize=5, label=label if axes is panels[0] else None)
        axes.set(xscale="log", title=f"{shapes} shapes", xlabel="degrees: median, and the line to 90 %")
        axes.set_yticks(range(len(names)), names)
        axes.grid(axis="x", linewidth=0.4)
    figure.legend(fontsize=8, ncols=2, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    save(figure, folder, "directions.svg", bbox_inches="tight")


def draw_solvers(folder):
    """What a second of computing buys: runs that end well by the processor's time, at each library's first time step."""
    runs = {}
    for elastic, name in (("rigid", "solvers.csv"), ("elastic", "deforming.csv")):
        rows = [row for row in read(folder, name) if row["phase"] != "tuned" and row["outcome"] != "does not apply"]
        steps = {row["library"]: row["time_step"] for row in rows[::-1]}
        for row in rows:
            start = row.get("start") or ("deep" if row["kind"] == "part" else "apart")
            if row["time_step"] == steps[row["library"]]:
                is_well, seconds = row["outcome"] in ("done", "parted", "carried"), float(row.get("cost") or row["seconds"])
                runs.setdefault(f"{elastic}, {start}", {}).setdefault(row["library"], []).append((is_well, seconds))
    figure, panels = plot.subplots(1, len(runs), figsize=(8.4, 2.4), sharey=True, layout="constrained")
    marks = {}
    for axes, (title, found) in zip(panels, runs.items()):
        for library, ends in found.items():
            colour, marker = SOLVERS[library]
            share = 100 * sum(is_well for is_well, _ in ends) / len(ends)
            (marks[library],) = axes.plot(numpy.median([seconds for _, seconds in ends]), share, marker, color=colour,
                                          markersize=6, linestyle="none", alpha=0.8)
        axes.set(title=title, xscale="log", ylim=(-5, 105), xlim=(1e-3, 5) if title.startswith("rigid") else (0.2, 100))
        axes.grid(linewidth=0.4)
        axes.minorticks_off()
    panels[0].set_ylabel("% ended well")
    panels[len(panels) // 2].set_xlabel("the processor's seconds of a run, rigid: of a second; median")
    ordered = [library for library in SOLVERS if library in marks]
    figure.legend([marks[library] for library in ordered], ordered, fontsize=8, ncols=4, loc="lower center",
                  bbox_to_anchor=(0.5, 1.0))
    save(figure, folder, "solvers.svg", bbox_inches="tight")


def draw(folder):
    draw_solvers(folder)
    draw_free(folder)
    draw_simulate(folder)
    draw_directions(folder)


if __name__ == "__main__":
    draw_in_folder(__doc__, "docs/penetration", "penetration", draw, ": run scripts/penetration.sh --full")
