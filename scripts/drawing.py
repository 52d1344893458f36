# SPDX-License-Identifier: MIT OR Apache-2.0
"""What the programs that draw have in common: modules, the command line, and figures that are the same from run to run."""

import argparse
import os
import re
import sys

import document_tables

try:
    import matplotlib
    import numpy

    matplotlib.use("svg")
    import matplotlib.pyplot as plot  # after the choice of output
    from matplotlib.ticker import FuncFormatter, NullFormatter
except ModuleNotFoundError:
    matplotlib = numpy = plot = FuncFormatter = NullFormatter = None  # --help works without


def save(figure, folder, name, **how):
    """Neither date nor random names: the same figures give the same file. Nor indents, nor parts of a hundredth of a
    point, which are a third of it."""
    path = os.path.join(folder, name)
    figure.savefig(path, metadata={"Date": None}, **how)
    plot.close(figure)
    with open(path, encoding="utf-8") as file:
        text = re.sub(r"\n +", "\n", file.read())
    # Within tags alone: what is written in a figure stays.
    text = re.sub("<[^>]*>", lambda tag: re.sub(r"(\d\.\d\d)\d+", r"\1", tag[0]), text)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def run(work, arguments, hint=""):
    """Does the work, or says why it could not be done."""
    program = os.path.basename(sys.argv[0])
    if matplotlib is None:
        sys.exit(f"{program}: matplotlib or numpy is missing: apt-get install python3-matplotlib python3-numpy")
    try:
        work(*arguments)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"{program}: {error}{hint}")


def draw_in_folder(text, folder, salt, draw, hint=""):
    """The program that draws from the files of a folder into it. Its text is what --help says."""
    parser = argparse.ArgumentParser(
        description=text.split("\n\n", maxsplit=1)[0],
        epilog="Exit status: 0 when drawn, 1 when something is missing, 2 for a wrong command line.",
    )
    parser.add_argument("folder", nargs="?", default=folder, help=f"default: {folder}")
    arguments = parser.parse_args()

    def work(folder):
        # Letters as text and fixed names keep the files small and the same from run to run.
        matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": salt, "font.size": 9})
        draw(folder)

    run(work, [arguments.folder], hint)


def draw_and_tabulate(text, folder, table, draw):
    """The program that draws into a folder, prints the lines that `draw` gives, and puts them into a document."""
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", default=folder)
    parser.add_argument("document", nargs="?")

    def work(folder, document):
        lines = "\n".join(draw(folder))
        print(lines)
        if document:
            document_tables.renew(document, {table: lines})

    arguments = parser.parse_args()
    run(work, [arguments.folder, arguments.document])
