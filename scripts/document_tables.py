"""Tables in documents: each stands between lines <!-- name --> and <!-- end -->."""

import re


def renew(path, tables):
    """Puts the text of each table in its place in the document."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    for name, lines in tables.items():
        place = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        if not place.search(text):
            raise ValueError(f"{path} has no lines <!-- {name} --> and <!-- end -->: put them where the table goes")
        text = place.sub(lambda match, lines=lines: match[1] + lines + "\n" + match[2], text)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
