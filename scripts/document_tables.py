"""Figures in documents, and the CSV files that they come from.

A figure stands between <!-- name --> and <!-- end -->, a table on lines of its own. The first line of a CSV file is a
comment that says the date, commit and seed of its figures, and the command that measured them (`head_csv` in common.sh).
"""

import csv
import re


def rows(path):
    """The rows of a CSV file, as dictionaries."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def renewed(path, figures):
    """The text of the document, with each figure in its places."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    for name, figure in figures.items():
        place = re.compile(rf"(<!-- {re.escape(name)} -->\n?).*?(\n?<!-- end -->)", re.DOTALL)
        if not place.search(text):
            raise ValueError(f"{path} has no <!-- {name} --> and <!-- end -->: put them where the figure goes")
        text = place.sub(lambda match, figure=figure: match[1] + figure + match[2], text)
    return text


def renew(path, figures):
    """Puts each figure in its places in the document."""
    text = renewed(path, figures)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
