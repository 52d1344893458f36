#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Measures SOFA's own scene of its ray tracing, RayTraceCollision.scn, with other narrow phases and responses.

Makes a variant of the scene for each, without what is only looked at, runs them by turns through run_scene and prints the
medians of steps per second of processor time and of milliseconds of a step, and what became of the bodies.
With --map it runs six seconds of each at several time steps instead, and prints lines for docs/hosts/map.csv: a run is ok
where no cell was ever inverted and all tori lie in the bowl.
Exit status: 0 measured; 1 a run failed; 2 wrong usage.
"""
import argparse
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

LINE = re.compile(r"(\d+) steps, ([\d.]+)/s, ([\d.]+) ms, collision ([\d.]+) ms, inverted (\d+), (.*), hash (\w+)")
SOLVERS = ("EulerImplicitSolver", "CGLinearSolver")


def bare(scene):
    """The scene without windows and without asking for modules, which are loaded already."""
    root = tree.parse(scene).getroot()
    for node in list(root.iter()):
        for child in list(node):
            looks = child.tag in ("OglModel", "RequiredPlugin") or child.get("name") in ("Visu", "meshLoader_4")
            if looks:
                node.remove(child)
    return root


def ours(root, **narrow_phase):
    """The same with raycontact's narrow phase."""
    for node in root.iter():
        for child in node:
            if child.tag == "RayTraceNarrowPhase":
                child.tag = "RaycontactNarrowPhase"
                child.attrib.update(narrow_phase)
            if child.tag == "TriangleOctreeCollisionModel":
                child.tag = "TriangleCollisionModel"
            if child.tag == "NewProximityIntersection":
                nearer = {"alarmDistance": "0.5", "contactDistance": "0"}
                child.attrib.update(nearer if "publishContacts" in narrow_phase else {})
    return root


def own_response(root, **contact):
    tree.SubElement(root, "RaycontactForceField", name="contact", **contact)
    # Forces of no solver come before the solvers.
    field = root[-1]
    root.remove(field)
    root.insert([child.tag for child in root].index("Node"), field)
    return root


def common_solver(root, **contact):
    """All bodies and the contact under one solver."""
    bodies = tree.Element("Node", name="Bodies")
    tree.SubElement(bodies, "EulerImplicitSolver", rayleighStiffness="0", rayleighMass="0")
    tree.SubElement(bodies, "CGLinearSolver", iterations="250", tolerance="1.0e-9", threshold="1.0e-9")
    tree.SubElement(bodies, "RaycontactForceField", name="contact", **contact)
    for node in [child for child in root if child.tag == "Node" and child.get("name") != "Floor"]:
        root.remove(node)
        for solver in [child for child in node if child.tag in SOLVERS]:
            node.remove(solver)
        bodies.append(node)
    root.insert([child.tag for child in root].index("Node"), bodies)
    return root


def no_collision(root):
    for child in list(root):
        if child.tag != "Node" and child.tag != "DefaultAnimationLoop":
            root.remove(child)
    return root


QUIET = {"publishContacts": "0"}
VARIANTS = {
    "SOFA's ray tracing and response": lambda scene: bare(scene),
    "ours, SOFA's response": lambda scene: ours(bare(scene)),
    "ours, own response, a common solver": lambda scene: common_solver(ours(bare(scene), **QUIET)),
    "ours, own response, a solver each": lambda scene: own_response(ours(bare(scene), **QUIET)),
    "the same by accuracy, a common solver": lambda scene: common_solver(
        ours(bare(scene), sampleSpacing="-1", **QUIET)),
    "no collision, a solver each": lambda scene: no_collision(bare(scene)),
}


# Their names in the map.
MAPPED = {
    "SOFA's ray tracing and response": "sofa",
    "ours, SOFA's response": "raycontact_sofa_response",
    "ours, own response, a common solver": "raycontact",
    "ours, own response, a solver each": "raycontact_own_solvers",
}
LOWEST = -10  # the height of a centre below which a torus has left the bowl


def verdict(result):
    """How a run ended, by its line; none is one whose numbers are not finite."""
    if result is None:
        return "exploded"
    if int(result[4]) > 0:
        return "inverted"
    height = re.search(r"centres \S+ (\S+)\.\.", result[5])
    return "ok" if float(height[1]) > LOWEST else "passed_through"


def run_once(arguments, scene, steps, dt):
    """The program's last line about the run, or None, and what it said."""
    command = [arguments.driver, "--steps", str(steps), "--dt", str(dt)]
    for library in arguments.load:
        command += ["--load", library]
    run = subprocess.run([*command, scene], capture_output=True, text=True, check=False)
    lines = LINE.findall(run.stdout)
    return (lines[-1] if lines else None), run.stdout[-2000:] + run.stderr[-2000:]


def print_map(arguments, folder, names):
    for place, name in enumerate(names):
        for dt in (0.01, 0.02, 0.04, 0.08):
            result, _ = run_once(arguments, f"{folder}/{place}.scn", round(6 / dt), dt)
            print(f"SOFA,ten_tori,{MAPPED[name]},{dt},{verdict(result)}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", help="SOFA's examples/Component/Collision/Detection/RayTraceCollision.scn")
    parser.add_argument("--driver", default="run_scene", help="the program run_scene (default: run_scene)")
    parser.add_argument("--load", action="append", default=[], help="a plugin's library; may be given more than once")
    parser.add_argument("--steps", default="400", help="how many (default 400)")
    parser.add_argument("--dt", default="0.01", help="the step in s (default 0.01)")
    parser.add_argument("--rounds", type=int, default=3, help="how often each variant runs (default 3)")
    parser.add_argument("--only", help="only variants whose name has this in it")
    parser.add_argument("--map", action="store_true", help="lines for docs/hosts/map.csv instead of times")
    arguments = parser.parse_args()
    known = MAPPED if arguments.map else VARIANTS
    names = [name for name in known if arguments.only is None or arguments.only in name]
    found = {name: [] for name in names}
    with tempfile.TemporaryDirectory() as folder:
        for place, name in enumerate(names):
            tree.ElementTree(VARIANTS[name](arguments.scene)).write(pathlib.Path(folder) / f"{place}.scn")
        if arguments.map:
            print_map(arguments, folder, names)
            return 0
        for _ in range(arguments.rounds):
            for place, name in enumerate(names):
                result, said = run_once(arguments, f"{folder}/{place}.scn", arguments.steps, arguments.dt)
                if result is None:
                    print(f"measure.py: {name}: no result; the end of its log:\n{said}", file=sys.stderr)
                    return 1
                found[name].append(result)
    for name in names:
        runs = found[name]
        rate, step, collision = (statistics.median(float(run[k]) for run in runs) for k in (1, 2, 3))
        print(f"{name}: {rate:.1f} steps/s, {step:.2f} ms a step, collision {collision:.2f} ms, "
              f"inverted {runs[0][4]}, {runs[0][5]}, steps {runs[0][0]}, hash {runs[0][6]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
