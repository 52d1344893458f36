# SPDX-License-Identifier: MIT OR Apache-2.0
"""What MkDocs does besides when it makes the site of the manual: see mkdocs.yml."""

import pathlib
import posixpath
import re
import shutil
import xml.etree.ElementTree as ElementTree

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).parents[2]
# What Doxygen has made of the headers.
HTML, XML = ROOT / "build/reference/html", ROOT / "build/reference/xml"
C_HEADERS = "raycontact", "base", "mesh", "scene", "contacts", "contact_system", "queries", "state", "distributed"
LINK = re.compile(r"(?<!!)\[([^]]*)\]\(([^):#]+)(#[^)]*)?\)")


def on_files(files, config):
    """The site has Doxygen's pages, too."""
    for path in sorted(HTML.rglob("*")):
        if path.is_file():
            name = f"reference/c/{path.relative_to(HTML).as_posix()}"
            files.append(File.generated(config, name, abs_src_path=str(path)))


def on_page_markdown(markdown, page, config, files):
    if page.file.src_uri == "reference/c.md":
        markdown += "\n\n".join(names_of_headers())
    return LINK.sub(lambda link: link_within(files, page.file.src_uri, link), markdown)


def link_within(files, source, link):
    """A link to a file of the repository that the site lacks becomes its path."""
    target = posixpath.normpath(posixpath.join("docs", posixpath.dirname(source), link[2]))
    file = files.get_file_from_path(posixpath.relpath(target, "docs"))
    if not (ROOT / target).exists() or (file and file.inclusion.is_included()):
        return link[0]
    return f"`{target}`" if link[1].strip("`") in target else f"{link[1]} (`{target}`)"


def names_of_headers():
    """Every name of the C headers and every class of C++ with its brief text, so that the search finds them."""
    yield from (text for header in C_HEADERS for text in texts_of_header(header))
    yield "## Classes of C++"
    index = ElementTree.parse(XML / "index.xml")
    compounds = index.findall("compound[@kind='class']") + index.findall("compound[@kind='struct']")
    # An inline namespace is nothing a user writes.
    found = {compound.findtext("name").replace("with_exceptions::", ""): compound.get("refid") for compound in compounds}
    for name in sorted(found):
        page = read(found[name])
        if "::" in name and page.get("prot") == "public" and text_of(page, "briefdescription"):
            yield from texts_of(name, f"{page.get('id')}.html", page, members_of(page))


def members_of(page):
    """Those with a text; overloads once."""
    found = {}
    for member in page.iter("memberdef"):
        if member.get("prot") == "public" and text_of(member, "briefdescription"):
            found.setdefault(member.findtext("name"), member)
    return found.values()


def texts_of_header(header):
    page = read(f"{header.replace('_', '__')}_8h")
    yield f"\n\n## [{header}.h](c/{page.get('id')}.html)\n{text_of(page, 'briefdescription')}"
    structs = {inner.text: read(inner.get("refid")) for inner in page.iter("innerclass")}
    for name, struct in structs.items():
        yield from texts_of(name, f"{struct.get('id')}.html", struct, struct.iter("memberdef"))
    for member in page.iter("memberdef"):
        name, is_typedef = member.findtext("name"), member.get("kind") == "typedef"
        # A typedef has the name of its struct or enum, unless the struct is opaque.
        if text_of(member, "briefdescription") and not (is_typedef and (name in structs or is_enum(page, name))):
            yield from texts_of(name, place_of(member), member, member.iter("enumvalue"))


def texts_of(name, place, described, members):
    yield f"### [{name}](c/{place})\n{text_of(described, 'briefdescription')}"
    yield "\n".join(f"* `{member.findtext('name')}`: {text_of(member, 'briefdescription')}" for member in members)


def is_enum(page, name):
    return any(member.get("kind") == "enum" and member.findtext("name") == name for member in page.iter("memberdef"))


def place_of(member):
    page, anchor = member.get("id").rsplit("_1", 1)
    return f"{page}.html#{anchor}"


def read(name):
    return ElementTree.parse(XML / f"{name}.xml").find("compounddef")


def text_of(described, which):
    return " ".join("".join(described.find(which).itertext()).split())


def on_post_build(config):
    """Leaves out what no page of the site loads: the theme's source maps and its other languages, and the index of the search,
    which is read from disk as a script."""
    scripts = pathlib.Path(config.site_dir) / "assets"
    (pathlib.Path(config.site_dir) / "search/search_index.json").unlink()
    shutil.rmtree(scripts / "javascripts/lunr")
    for path in scripts.rglob("*.map"):
        path.unlink()
