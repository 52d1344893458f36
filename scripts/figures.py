#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Holds README.md and the pages of docs/ to the CSV files that their figures come from.

Usage: figures.py [--renew]

Every figure between <!-- name --> and <!-- end --> is worked out anew, so two pages that use one name say the same.
A name is that of a table or figure below, or one of these, with files below docs/:
  measured FILE...                 where the figures of these files come from
  ratio FILE A / B WORKLOAD...     the time of a step by A over that by B, each METHOD[:PRECISION[:THREADS]]; both
                                   must have contacts there
  ok SCENE METHOD                  runs of the stability map that end well
Also looked at: that each CSV file says where it comes from, that a page which links one says so too, that the tables
which the measuring programs write are of their files, and that exploratory figures are in the notebook alone.
With --renew the pages get the figures of the files.
Exit status: 0 when all pages hold; 1 when not, with what differs; 2 for a wrong command line.
"""

import argparse
import functools
import pathlib
import re
import statistics
import sys

import document_tables
import draw_stability
import tabulate_accuracy
import tabulate_penetration
from tabulate_accuracy import table

ROOT = pathlib.Path(__file__).parents[1]
DOCS = ROOT / "docs"
NOTEBOOK = DOCS / "performance_notebook.md"
HEAD = re.compile(r"# date (\d{4}-\d\d-\d\d), commit ([0-9a-f]{7,}(?:-dirty)?), seed (\d+|none), command (\S.*)\n")
# By scripts/draw_distributed.py, from a file of parts too large to keep.
DRAWN = {"model"}


@functools.cache
def rows(name):
    return document_tables.rows(DOCS / name)


def only(name, **wanted):
    return [row for row in rows(name) if all(row[column] == value for column, value in wanted.items())]


def span(values, form="{:.3g}"):
    low, high = form.format(min(values)), form.format(max(values))
    return low if low == high else f"{low} to {high}"


def head(path):
    with open(path, encoding="utf-8") as file:
        found = HEAD.fullmatch(file.readline())
    if not found:
        raise ValueError(f"{path} does not begin with '# date …, commit …, seed …, command …' (head_csv in common.sh)")
    return found.groups()


def measured(page, *names):
    lines = []
    for name in names:
        date, commit, seed, command = head(DOCS / name)
        link = name if page.parent == DOCS else f"docs/{name}"
        lines.append([f"[{name.split('/', maxsplit=1)[1]}]({link})", date, commit, seed, f"`{command}`"])
    return table(["figures from", "date", "commit", "seed", "command"], lines)


def step(name, how, workload):
    """Contacts and microseconds of a step; of the default in double precision, of others in single, on one thread."""
    method, precision, threads = (how.split(":") + ["", ""])[:3]
    precision = precision or ("f64" if method in ("raycontact", "raycontact-rust") else "f32")
    found = only(name, method=method, workload=workload, precision=precision, threads=threads or "1")
    if not found:
        raise ValueError(f"{name} has no step of {how} on {workload}")
    return int(found[0]["contacts"]), float(found[0]["total_us"])


def ratio(name, above, _, below, *workloads):
    steps = [(step(name, above, workload), step(name, below, workload)) for workload in workloads]
    if not all(contacts for pair in steps for contacts, _ in pair):
        raise ValueError(f"{name}: no contacts on one of {workloads}, so a ratio says nothing")
    return span([a / b for (_, a), (_, b) in steps])


# The columns of the table in README.md: names in performance/detect.csv and chart/chart.csv, and in penetration/.
LIBRARIES = {
    "raycontact": ("raycontact", "raycontact"), "Embree, Algorithm 1": ("embree-refit", "Algorithm 1 on Embree"),
    "FCL": ("fcl-aabb", "FCL"), "Bullet": ("bullet-vf", "Bullet"), "MuJoCo": (None, "MuJoCo"),
    "Drake": (None, "Drake, hydroelastic"), "coal": (None, "coal"),
}
DEFAULT = "law=pressure sampling=accuracy:0.01 precision=f64 layout=wide edges=on weights=area"


def times_over(method):
    """The default's time over that of the method, on each workload where both have contacts."""
    name = "performance/detect.csv"
    steps = [row for row in only(name, method=method, threads="1") if row["contacts"] not in ("", "0")]
    return [step(name, "raycontact", row["workload"])[1] / float(row["total_us"]) for row in steps]


def time_of(method):
    found = times_over(method)
    return f"{statistics.median(found):.2g} / {max(found):.2g}" if found else "–"


# Embree hands out rays; the areas of its contacts are its adapter's.
FORCES = {"raycontact": DEFAULT, "embree-refit": "precision=f32 weights=area"}


def error_of(method):
    if method not in FORCES:
        return "–"
    found = [100 * float(row["force_error"]) for row in only("chart/chart.csv", method=method, settings=FORCES[method])]
    return f"{statistics.median(found):.2g} % / {max(found):.3g} %"


def direction_of(library, shapes, judge):
    row = only("penetration/measure.csv", library=library, kind="random", shapes=shapes, judge=judge)[0]
    silent = f", {row['silent']} of {row['poses']} silent" if row["silent"] != "0" else ""
    return " / ".join(f"{float(f'{float(row[column]):.2g}'):g}°" for column in ("median", "worst")) + silent


def pressed(library, column):
    row, = only("penetration/measure.csv", library=library, kind="pressed", judge="hydroelastic")
    return f"{float(row[column]):.2g}°"


def recovery_of(library, shapes):
    """Of poses deep in one another, all kinds together and the worst kind."""
    parts = {}
    for row in only("penetration/free.csv", library=library, shapes=shapes):
        if row["kind"] not in ("shallow", "edges"):
            freed, asked = parts.get(row["kind"], (0, 0))
            parts[row["kind"]] = freed + int(row["freed"]), asked + int(row["poses"]) - int(row["refused"])
    freed, asked = (sum(values) for values in zip(*parts.values()))
    worst = min(100 * freed / asked for freed, asked in parts.values() if asked)
    return f"{100 * freed / asked:.4g} % / {worst:.4g} %"


def claims():
    methods, libraries = zip(*LIBRARIES.values())
    return table(["median / worst", *LIBRARIES], [
        ["time: the default's over theirs", *map(time_of, methods)],
        ["force, off the limit of its own law", *map(error_of, methods)],
        *([f"direction, to {name}, {shapes}", *(direction_of(library, shapes, judge) for library in libraries)]
          for judge, name in (("hydroelastic", "hydroelastic contact"), ("overlap_volume", "an even pressure"))
          for shapes in ("convex", "concave")),
        *([f"deep starts that come apart, {shapes}: all / worst kind", *(recovery_of(library, shapes) for library in libraries)]
          for shapes in ("convex", "concave")),
    ])


# The rows of the table in docs/choosing.md: what one wants, what to take, settings; Embree's are the last.
CHOICES = [
    ("something that works", "the default, an accuracy of 0.01", DEFAULT),
    ("the same, faster", "single precision", DEFAULT.replace("f64", "f32")),
    ("fewer contacts", "an accuracy of 0.03", DEFAULT.replace("0.01", "0.03")),
    ("as few as will do", "an accuracy of 0.1", DEFAULT.replace("0.01", "0.1")),
    ("more exact forces", "an accuracy of 0.003", DEFAULT.replace("0.01", "0.003")),
    ("coarse meshes, cheaply", "rays from the vertices", DEFAULT.replace("accuracy:0.01", "vertices")),
    ("the paper's speed, where the direction may be some degrees off",
     "ray lengths, rays from the vertices, single precision",
     "law=ray-length sampling=vertices precision=f32 layout=wide edges=on weights=area"),
    ("for comparison", "Embree with Algorithm 1, single precision", "precision=f32 weights=area"),
]
SCENES = {"deep-tori": "deep tori", "stack": "stack of coarse tori", "resolution": "ball on a huge triangle",
          "spot-fandisk": "cow and machine part"}


def choice(scene, settings):
    method = "raycontact" if settings.startswith("law") else "embree-refit"
    row = only("chart/chart.csv", scene=scene, method=method, settings=settings)[0]
    error = 100 * float(row["force_error"])
    text = f"{float(row['time_over_lower_bound']):.0f}, {error:.{2 if error < 0.095 else 1 if error < 9.95 else 0}f} %"
    return text if settings.startswith("law=pressure") else f"{text}, {float(row['direction_error']):.1f}°"


def instructions():
    counted = {(row["workload"], row["mode"]): int(row["instructions"])
               for row in only("performance/instructions.csv", path="avx2")}
    return {workload: counted[workload, "default"] / counted[workload, "paper"] for workload, _ in counted}


def defaults():
    name, lines = "performance/defaults.csv", []
    for workload in dict.fromkeys(row["workload"] for row in rows(name)):
        contacts, own = step(name, "raycontact", workload)
        rust, paper, embree = (step(name, f"{method}", workload)[1]
                               for method in ("raycontact-rust", "raycontact-paper", "embree-refit"))
        ratios = [f"{own / paper:.2f}", f"{embree / own:.2f}"] if contacts else ["–", "–"]
        lines.append([workload, f"{contacts}", f"{own:.1f}", f"{rust:.1f}", f"{own / rust:.2f}", *ratios])
    return table(["workload", "contacts", "`raycontact`, µs", "from Rust, µs", "C / Rust",
                  "`raycontact` / `raycontact-paper`", "Embree / `raycontact`"], lines)


QUERIES = "performance/queries.csv"


def queries(question, positions, own):
    """By library, how many times as long as `own` it takes: a number for each surface and set of points."""
    found, places = {}, ("surface", "points")
    listed = only(QUERIES, question=question, positions=positions)
    times = {tuple(row[place] for place in places): float(row["us"]) for row in listed if row["library"] == own}
    for row in listed:
        if not row["library"].startswith("raycontact") and (own == "raycontact" or row["precision"] == "f32"):
            ratio_here = float(row["us"]) / times[tuple(row[place] for place in places)]
            found.setdefault(row["library"], []).append(ratio_here)
    return found


def median_and_least(values):
    return f"{statistics.median(values):.2g} / {min(values):.2g}" if values else "–"


def queries_table():
    libraries = [name for name in dict.fromkeys(row["library"] for row in rows(QUERIES))
                 if not name.startswith("raycontact")]
    lines = []
    for own in ("raycontact", "raycontact, single"):
        for question in ("distance", "inside", "signed"):
            for positions in ("moved", "still"):
                found = queries(question, positions, own)
                precision = "single" if own.endswith("single") else "double"
                lines.append([f"{question}, {positions}, {precision}",
                              *(median_and_least(found.get(library)) for library in libraries)])
    return table(["median / least of their time over ours", *libraries], lines)


def queries_by_surface():
    """Where the fastest of the others stands, by surface and points: ours in double precision over its time."""
    best, columns = {}, {}
    for row in rows(QUERIES):
        key, column = (row["surface"], row["triangles"], row["points"]), f"{row['question']}, {row['positions']}"
        columns[column] = None
        kind = "own" if row["library"] == "raycontact" else None if row["library"].startswith("ray") else "other"
        if kind:
            here = best.setdefault(key, {}).setdefault(column, {})
            if kind not in here or float(row["us"]) < here[kind][0]:
                here[kind] = float(row["us"]), row["library"]
    cell = lambda here: f"{here['other'][0] / here['own'][0]:.2f} ({here['other'][1]})"  # noqa: E731
    return table(["surface", "triangles", "points", *columns],
                 [[*key, *(cell(best[key][column]) for column in columns)] for key in best])


def queries_wrong():
    found = {}
    for row in rows(QUERIES):
        off, wrong = found.get(row["library"], (0, 0))
        # One check serves the moved and the still.
        is_counted = row["question"] != "distance" and row["positions"] == "still"
        found[row["library"]] = max(off, float(row["worst"])), wrong + is_counted * int(row["wrong_side"])
    return table(["library", "version", "largest error of a distance", "wrong sides"], [
        [library, only(QUERIES, library=library)[0]["version"], f"{off:.1g}",
         f"{wrong}" if only(QUERIES, library=library, question="signed") else "–"]
        for library, (off, wrong) in found.items()])


def deforming_runs():
    """All that count. `column`: the library, with its time step where it has several."""
    listed = [row for row in rows("penetration/deforming.csv") if row["phase"] != "tuned"]
    for row in listed:
        steps = {other["time_step"] for other in listed if other["library"] == row["library"]}
        row["column"] = row["library"] + f", {row['time_step']} s" * (len(steps) > 1)
        row["is_well"] = row["outcome"] in ("parted", "carried")
    return listed


def deforming_summary():
    """Of each library and start how many scenes end well, and in what time."""
    listed, lines = deforming_runs(), []
    starts = list(dict.fromkeys(row["start"] for row in listed))
    for column in dict.fromkeys(row["column"] for row in listed):
        line = [column]
        for start in starts:
            found = [row for row in listed if (row["column"], row["start"]) == (column, start) and row["seconds"]]
            well = f"{sum(row['is_well'] for row in found)} of {len(found)}"
            spent = f"{statistics.median(float(row['seconds']) for row in found):.2g}" if found else ""
            line += [f"{found[0]['stiffness']}: {well}", spent] if found else ["does not apply", "–"]
        lines.append(line)
    return table(["library", *(head for start in starts for head in (f"{start}, ended well", "seconds"))], lines)


def deforming(*starts):
    """Of each scene of these starts what became of it with each library."""
    def cell(row):
        inverted = f", {row['inverted']} inverted" * (row["inverted"] not in ("", "0"))
        if row["outcome"] == "parted":
            energy = f", {float(row['energy']):.3g} J" * (row["start"] == "deep")
            return f"{row['parted_after'] or '–'} / {row['seconds']}{energy}{inverted}"
        if row["outcome"] in ("stuck", "carried", "not carried"):
            return f"{'no, ' * (row['outcome'] != 'carried')}{row['depth']} deep{inverted} / {row['seconds']}"
        return f"{row['outcome']}{' / ' * bool(row['seconds'])}{row['seconds']}"

    listed = [row for row in deforming_runs() if row["start"] in starts]
    cells = {(row["scene"], row["start"], row["column"]): cell(row) for row in listed}
    columns = list(dict.fromkeys(row["column"] for row in listed))
    scenes = dict.fromkeys((row["scene"], row["start"], row["tetrahedra"]) for row in listed)
    return table(["scene", "start", "tetrahedra", *columns],
                 [[*scene, *(cells[*scene[:2], column] for column in columns)] for scene in scenes])


def deforming_tuned():
    """Of each library and start, the scenes of the first seed that end well by each declared stiffness."""
    tuned, lines = only("penetration/deforming.csv", phase="tuned"), []
    for library in dict.fromkeys(row["library"] for row in tuned):
        for start in dict.fromkeys(row["start"] for row in tuned):
            found = [row for row in tuned if (row["library"], row["start"]) == (library, start)]
            well = {}
            for row in found:
                well.setdefault(row["stiffness"], []).append(row["outcome"] in ("parted", "carried"))
            best = max(map(sum, well.values()))
            texts = [f"{stiffness}: {sum(ends)} of {len(ends)}" for stiffness, ends in well.items()]
            taken = next(number for number, ends in enumerate(well.values()) if sum(ends) == best)
            texts[taken] = f"**{texts[taken]}**"
            lines.append([library, start, *texts])
    return table(["library", "start", "documented", "second", "third"], lines)


def deep():
    name, lines = "performance/deep.csv", []
    for workload in dict.fromkeys(row["workload"] for row in rows(name)):
        contacts, own = step(name, "raycontact-paper", workload)
        ratios = [f"{step(name, embree, workload)[1] / step(name, paper, workload)[1]:.2f}" if contacts else "–"
                  for paper, embree in (("raycontact-paper", "embree-refit"),
                                        ("raycontact-paper-avx2", "embree-refit-avx2"),
                                        ("raycontact-paper-baseline", "embree-refit-sse2"))]
        lines.append([*workload.split("@"), f"{contacts}", f"{own:.0f}", *ratios])
    return table(["pair of bodies", "apart", "contacts", "µs", "Embree", "AVX2 each", "SSE2 each"], lines)


def pivot(listed, index, column, value, form):
    """Of listed rows: a row for each set of values of the columns `index`, a column for each value of `column`."""
    found = {}
    for row in listed:
        found.setdefault(tuple(row[part] for part in index), {})[row[column]] = form.format(float(row[value]))
    heads = list(dict.fromkeys(row[column] for row in listed))
    return table([*index, *heads], [[*key, *(cells.get(head, "–") for head in heads)] for key, cells in found.items()])


def apart(found):
    return " of ".join(f"{sum(int(row[name]) for row in found):_}".replace("_", " ") for name in ("separated", "poses"))


def poses_table():
    names = "poses", "separated", "stuck", "exploded", "median_steps", "worst_steps"
    return table(["arguments", "last line"], [
        [f"`{row['arguments']}`", "`" + " ".join(f"{name}={row[name]}" for name in names) + "`"]
        for row in rows("stability/poses.csv")])


def one_by_one(method):
    """The time of Embree 3.13's single rays over that of these, with AVX2."""
    return span([float(row["embree_single_over_this"]) for row in only("performance/rays_avx2.csv", method=method)],
                "{:.2f}")


def figures():
    """By name, the text of each table or figure."""
    runs = draw_stability.read(DOCS / "stability/map.csv")
    forces = [row for row in only("accuracy/forces.csv", law="default") if "hydroelastic (degrees)" in row["bodies"]]
    poses = rows("stability/poses.csv")
    others = [row for row in poses if "--seed" in row["arguments"]]
    exits = {(row["kind"], row["library"][:4]): float(row["exits_ratio"]) for row in rows("penetration/self.csv")
             if row["library"].startswith("Chen") or row["library"].endswith("own exits")}
    inside = [float(row["inside_ratio"]) for row in only("penetration/detect.csv", library="trimesh")]
    single = [float(row["embree_single_over_this"])
              for row in only("performance/rays.csv", method="raycontact-single", simd="avx512")]
    return {
        **tabulate_accuracy.tables(DOCS),
        **tabulate_penetration.tables(DOCS),
        "map": "\n".join(draw_stability.tables(runs, list(dict.fromkeys(row["scene"] for row in runs)))),
        "claims": claims(),
        "choices": table(["you want", "take", *SCENES.values()], [
            [want, take, *(choice(scene, settings) for scene in SCENES)] for want, take, settings in CHOICES]),
        "instructions": table(["workload", "instructions, default / paper's options"],
                              [[workload, f"{times:.1f}"] for workload, times in instructions().items()]),
        "instructions, span": span(instructions().values(), "{:.1f}"),
        "defaults": defaults(),
        "deep": deep(), "trees": pivot(only("performance/trees.csv", precision="f32", threads="1"), ["workload"], "method",
                                       "total_us", "{:.3g}"),
        "deforming": deforming("apart", "deep"), "deforming, loads": deforming("loaded"),
        "deforming, tuned": deforming_tuned(), "deforming, all": deforming_summary(),
        "queries": queries_table(), "queries by surface": queries_by_surface(), "queries, wrong": queries_wrong(),
        **{f"{question}, {positions}, {library}": median_and_least(queries(question, positions, "raycontact")[library])
           for question in ("distance", "inside", "signed") for positions in ("moved", "still")
           for library in queries(question, positions, "raycontact")},
        "rays, avx2": pivot(rows("performance/rays_avx2.csv"), ["workload", "kind"], "method", "embree_single_over_this",
                            "{:.2f}"),
        "single rays, avx2": one_by_one("raycontact-single"), "single rays of Embree 4": one_by_one("embree4-single"),
        "all rays": pivot(only("performance/rays.csv", simd="avx512"), ["workload", "kind"], "method",
                          "embree_single_over_this", "{:.2f}"),
        "anchors": pivot(rows("performance/anchors.csv"), ["scene", "library", "question"], "triangles", "ms", "{:.3g}"),
        "workloads": f"{len(times_over('embree-refit'))}", "workloads of Bullet": f"{len(times_over('bullet-vf'))}",
        "thorn, found": f"{100 * float(only('chart/chart.csv', scene='spike', method='embree-refit')[0]['recall']):.0f} %",
        "pressed into a gap, of ten the worst": pressed("raycontact", "ninety"),
        "pressed into a gap, without escapes": pressed("raycontact, no escape", "worst"),
        "contacts of folded": " and ".join(str(step("performance/detect.csv", method, "folded")[0])
                                           for method in ("embree-refit", "raycontact")),
        "poses": poses_table(),
        "poses apart": apart(poses[:1]), "poses of other seeds apart": apart(others),
        "poses, steps": poses[0]["median_steps"],
        "poses, most steps": f"{max(int(row['worst_steps']) for row in (poses[0], *others))}",
        "direction, medians": span([float(row["median"]) for row in forces], "{:.1f}"),
        "direction, worst": f"{max(float(row['worst']) for row in forces):.0f}",
        "own exits": span([exits[kind, "rayc"] / time for (kind, name), time in exits.items() if name == "Chen"],
                          "{:.2f}"),
        "inside, trimesh": span(inside, "{:.1f}"),
        "single rays": span(single, "{:.2f}"),
    }


def figure(page, name, known):
    kind, *words = name.split()
    if kind == "measured":
        return measured(page, *words)
    if kind == "ok":
        return draw_stability.count(only("stability/map.csv", scene=words[0], method=words[1]))
    return ratio(*words) if kind == "ratio" else known[name]


def cells(page, name):
    text = page.read_text(encoding="utf-8")
    lines = text.split(f"<!-- begin {name} -->\n")[1].split(f"<!-- end {name} -->")[0].splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def other_tables():
    """What is wrong with the tables that the measuring programs write."""
    workloads, _, *lines = cells(NOTEBOOK, "times")
    times = {(row["workload"], f"{float(row['total_us']):.1f}") for row in rows("performance/detect.csv")}
    told = {pair for line in lines for pair in zip(workloads[1:], line[1:]) if pair[1] != "–"}
    yield from (f"{NOTEBOOK.name}: no method takes {time} µs on {name}" for name, time in sorted(told - times))
    known = {(row["scene"], f"{float(row['time_over_lower_bound']):.1f}", row["contacts"],
              f"{100 * float(row['force_error']):.3f} %") for row in rows("chart/chart.csv") if row["force_error"]}
    for scene, setting, time, error, contacts, *_ in cells(DOCS / "choosing.md", "front")[2:]:
        if (scene, time, contacts, error) not in known:
            yield f"choosing.md: {setting} on {scene} is not what chart.csv says"


def look_at(page, known, renews):
    """What is wrong with a page. With `renews`, its figures are written anew first."""
    names = [name for name in re.findall(r"<!-- (.+?) -->", page.read_text(encoding="utf-8"))
             if not re.match("(begin|end)( |$)", name) and name not in DRAWN]
    wanted = {name: figure(page, name, known) for name in names}
    if renews:
        document_tables.renew(page, wanted)
    text = page.read_text(encoding="utf-8")
    for name in names:
        if document_tables.renewed(page, {name: wanted[name]}) != text:
            yield f"{page.name}: '{name}' is not what the CSV files say: scripts/figures.py --renew"
    shown = {word for name in names if name.startswith("measured ") for word in name.split()[1:]}
    for name in sorted(set(re.findall(r"\]\((?:docs/)?([^)]+\.csv)\)", text)) - shown):
        yield f"{page.name} does not say where {name} comes from: <!-- measured {name} -->"
    if "xploratory" in text and page != NOTEBOOK:
        yield f"{page.name} has exploratory figures: those belong in {NOTEBOOK.name}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     usage="%(prog)s [--renew]")
    parser.add_argument("--renew", action="store_true", help=argparse.SUPPRESS)
    renews = parser.parse_args().renew
    faults = []
    try:
        for path in sorted(DOCS.rglob("*.csv")):
            head(path)
        known = figures()
        for page in (ROOT / "README.md", *sorted(DOCS.glob("*.md"))):
            faults += look_at(page, known, renews)
        faults += other_tables()
    except (OSError, ValueError) as error:
        faults.append(str(error))
    except KeyError as error:
        faults.append(f"there is no figure or column {error}")
    sys.exit("\n".join(faults) or None)


if __name__ == "__main__":
    main()
