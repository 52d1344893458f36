#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Holds a model of what a step of a distributed scene takes against what was measured, and works out with it what the step
would take on many machines.

Usage: draw_distributed.py [FOLDER] [document.md]

FOLDER (default out/distributed) holds measured.csv and parts.csv and gets model.csv and scaling.svg. In the document, the
lines between "<!-- model -->" and "<!-- end -->" are replaced by the tables. scripts/distributed.sh runs the programs
and calls it. Needs Debian's python3-matplotlib and python3-numpy.

Exit status: 0; 1 where a file cannot be read; 2 for a wrong command line.
"""

import csv
import math
import os

import document_tables
from drawing import draw_and_tabulate, numpy, plot, save

LATENCY = 1.5e-6  # s, of a message
LINK = 100e9 / 8  # bytes/s
RANKS_PER_LINK = 32
GREETING = 72  # bytes that each rank tells all others
NEW = 0.1  # of the ghosts of a step, where bodies are divided every ten steps


def read(path):
    # Each run of a program begins with the names again.
    rows = [row for row in document_tables.rows(path) if row["ranks" if "ranks" in row else "parts"] not in ("ranks", "parts")]
    if not rows:
        raise ValueError(f"{path} has no rows: run scripts/distributed.sh")
    return [{name: float(value) for name, value in row.items()} for row in rows]


def medians(rows):
    """Of runs of equal size: bodies change ranks as the processor's time says, so runs differ a little."""
    groups = {}
    for row in rows:
        groups.setdefault((row["total_bodies"], row["ranks"], row["rank"]), []).append(row)
    return [{name: float(numpy.median([row[name] for row in group])) for name in group[0]} for group in groups.values()]


def fit(sizes, times):
    """Least squares of the relative errors."""
    return numpy.linalg.lstsq(sizes / times[:, None], numpy.ones(len(times)), rcond=None)[0]


class Model:
    """What a ray takes, from runs on one rank; what goes with a ghost, from runs on several."""

    def __init__(self, rows, parts):
        alone = [row for row in rows if row["ranks"] == 1]
        several = [row for row in rows if row["ranks"] > 1]
        if not alone or not several:
            raise ValueError("measured.csv has no runs on one rank or none on several: run scripts/distributed.sh")
        # Bodies of these runs have as many rays each, to 4 %: what a body takes besides cannot be told from them.
        rays = numpy.array([[row["rays"]] for row in alone])
        times = numpy.array([row["processor_ms"] for row in alone]) * 1e-3
        self.ray = float(fit(rays, times)[0])
        # Divisions know boxes, not rays.
        overlaps = {part["total_bodies"]: part["overlap"] for part in parts if part["parts"] == 1}
        known = [row for row in alone if row["total_bodies"] in overlaps]
        self.density = sum(row["rays"] for row in known) / sum(overlaps[row["total_bodies"]] for row in known)
        total = {name: sum(row[name] for row in several) for name in several[0]}
        ghosts = numpy.array([[row["ghosts"] - row["new_ghosts"], row["new_ghosts"]] for row in several])
        times = numpy.array([row["ghost_ms"] for row in several]) * 1e-3
        self.old_ghost, self.new_ghost = numpy.maximum(fit(ghosts, times), 0)
        self.ghost = (1 - NEW) * self.old_ghost + NEW * self.new_ghost
        self.position_bytes = total["position_bytes"] / total["ghosts"]
        self.force_bytes = total["force_bytes"] / total["ghost_pairs"]
        self.header_bytes = 56

    def compute(self, row):
        return self.ray * (row["rays"] if "rays" in row else self.density * row["overlap"])

    def step(self, part, parts, work=1.0):
        """The seconds of one rank, all others being ready when it is, and those of its exchange; `work`: of the computing."""
        out = (
            self.header_bytes * part["headers"]
            + self.position_bytes * part["lent"]
            + self.force_bytes * part["ghost_pairs"]
        )
        back = (
            self.header_bytes * part["headers"]
            + self.position_bytes * part["ghosts"]
            + self.force_bytes * part["given_pairs"]
        )
        bandwidth = LINK / RANKS_PER_LINK
        messages = part["near"] + 2 * part["neighbours"]
        collective = 5 * math.ceil(math.log2(max(parts, 2))) * LATENCY + parts * GREETING / bandwidth
        exchange = messages * LATENCY + collective + max(out, back) / bandwidth
        return work * self.compute(part) + self.ghost * part["ghosts"] + exchange, exchange


def work_out(model, rows):
    """For each division: what the longest of its ranks takes, and how much of that is what the mean rank computes."""
    lines = []
    for key in dict.fromkeys((row["total_bodies"], row["parts"]) for row in rows):
        of_key = [row for row in rows if (row["total_bodies"], row["parts"]) == key]
        steps = [model.step(row, key[1]) for row in of_key]
        longest = max(range(len(steps)), key=lambda k: steps[k][0])
        computing = float(numpy.mean([model.compute(row) for row in of_key]))
        total = {name: sum(row[name] for row in of_key) for name in of_key[0]}
        back = model.force_bytes * total["ghost_pairs"]
        lines.append(
            {
                "total_bodies": int(key[0]),
                "parts": int(key[1]),
                "pairs": int(total["pairs"]),
                "pairs_between": int(total["ghost_pairs"]),
                "ghosts": int(total["ghosts"]),
                "sent_MB": round((model.position_bytes * total["ghosts"] + back) / 1e6, 3),
                "computing_ms": round(1e3 * computing, 3),
                "largest_computing_ms": round(1e3 * max(model.compute(row) for row in of_key), 3),
                "longest_step_ms": round(1e3 * steps[longest][0], 3),
                "exchange_of_it_ms": round(1e3 * steps[longest][1], 3),
                "efficiency": round(computing / steps[longest][0], 4),
                "efficiency_of_a_tenth": round(0.1 * computing / max(model.step(row, key[1], 0.1)[0] for row in of_key), 4),
            }
        )
    return lines


def compare(model, rows, parts):
    """Measured against modelled computing: by ranks, the sum over ranks and the rank that is furthest off; on one rank also
    by boxes alone."""
    lines = []
    by_boxes = {part["total_bodies"]: 1e3 * model.compute(part) for part in parts if part["parts"] == 1}
    for key in dict.fromkeys((row["total_bodies"], row["ranks"]) for row in rows):
        of_key = [row for row in rows if (row["total_bodies"], row["ranks"]) == key]
        measured = [row["processor_ms"] for row in of_key]
        modelled = [1e3 * model.compute(row) for row in of_key]
        furthest = max(modelled[k] / measured[k] - 1 for k in range(len(measured))), min(
            modelled[k] / measured[k] - 1 for k in range(len(measured))
        )
        lines.append((int(key[0]), int(key[1]), sum(measured), sum(modelled), max(furthest, key=abs), by_boxes.get(key[0])))
    return lines


def tables(model, compared, worked):
    lines = [
        "| bodies, ranks | measured, ms of processor time, all ranks | by rays | off by | the rank furthest off | by boxes alone |",
        "| --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    for bodies, ranks, measured, modelled, furthest, by_boxes in compared:
        kind = "fitted" if ranks == 1 else "predicted"
        lines.append(
            f"| {bodies}, {ranks} | {measured:.0f} | {modelled:.0f}, {kind} | {100 * (modelled / measured - 1):+.1f} % | "
            f"{100 * furthest:+.1f} % | {100 * (by_boxes / measured - 1):+.1f} % |"
        )
    lines += [
        "",
        f"A ray takes {1e6 * model.ray:.2f} µs, a ghost {1e6 * model.old_ghost:.0f} µs where it is known and "
        f"{1e6 * model.new_ghost:.0f} µs where it is new; a ghost is {model.position_bytes:.0f} bytes, a pair with a ghost",
        f"{model.force_bytes:.0f} bytes back.",
        "",
        "| bodies | ranks | pairs between ranks | ghosts | sent, MB | computing, ms: mean, largest rank "
        "| longest step, ms: all, exchange | efficiency | with a tenth of the computing |",
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for line in worked:
        lines.append(
            f"| {line['total_bodies']} | {line['parts']} | {100 * line['pairs_between'] / line['pairs']:.1f} % | "
            f"{line['ghosts']} | {line['sent_MB']:.1f} | {line['computing_ms']:.0f}, {line['largest_computing_ms']:.0f} | "
            f"{line['longest_step_ms']:.0f}, {line['exchange_of_it_ms']:.1f} | {100 * line['efficiency']:.1f} % | "
            f"{100 * line['efficiency_of_a_tenth']:.1f} % |"
        )
    return lines


def draw_scaling(folder, compared, worked):
    figure, (left, right) = plot.subplots(1, 2, figsize=(9, 3.4))
    several = [line for line in compared if line[0] == 220]
    ranks = [line[1] for line in several]
    left.plot(ranks, [line[2] / line[1] for line in several], "o", color="#1b6ab3", label="measured here")
    left.plot(ranks, [line[3] / line[1] for line in several], "-", color="#d95f3b", label="model")
    left.set_title("220 bodies: computing of the mean rank", fontsize=9)
    left.set_ylabel("processor time of a step / ms", fontsize=8)
    left.set_ylim(bottom=0)
    left.set_xticks(ranks)
    series = {
        "1 000 000 bodies in all": ("#333333", [line for line in worked if line["total_bodies"] == 1000000]),
        "1000 bodies a rank": ("#1b6ab3", [line for line in worked if line["total_bodies"] == 1000 * line["parts"]]),
        "100 bodies a rank": ("#d95f3b", [line for line in worked if line["total_bodies"] == 100 * line["parts"]]),
    }
    for name, (colour, lines) in series.items():
        lines = sorted(lines, key=lambda line: line["parts"])
        x, y = [line["parts"] for line in lines], [100 * line["efficiency"] for line in lines]
        right.plot(x, y, "--", marker=".", color=colour, label=f"model: {name}")
    right.set_xscale("log")
    right.set_ylim(0, 105)
    right.set_title("32 ranks on one link of 100 Gb/s: not measured", fontsize=9)
    right.set_ylabel("efficiency / %", fontsize=8)
    for axes in (left, right):
        axes.set_xlabel("ranks", fontsize=8)
        axes.tick_params(labelsize=7)
        axes.legend(fontsize=7, frameon=False, loc="lower left")
        axes.spines[["top", "right"]].set_visible(False)
    # Neither date nor random names: the same figures give the same file.
    plot.rcParams["svg.hashsalt"] = "raycontact"
    plot.rcParams["svg.fonttype"] = "none"
    figure.tight_layout()
    save(figure, folder, "scaling.svg")


def draw(folder):
    measured = medians(read(os.path.join(folder, "measured.csv")))
    parts = read(os.path.join(folder, "parts.csv"))
    model = Model(measured, parts)
    worked = work_out(model, [part for part in parts if part["parts"] > 1])
    compared = compare(model, measured, parts)
    with open(os.path.join(folder, "measured.csv"), encoding="utf-8") as file:
        head = file.readline()
    with open(os.path.join(folder, "model.csv"), "w", newline="", encoding="utf-8") as file:
        file.write(head)
        writer = csv.DictWriter(file, list(worked[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(worked)
    draw_scaling(folder, compared, worked)
    return tables(model, compared, worked)


if __name__ == "__main__":
    draw_and_tabulate(__doc__, "out/distributed", "model", draw)
