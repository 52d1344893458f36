# SPDX-License-Identifier: MIT OR Apache-2.0
"""Builds the library with cargo and puts it into the wheel, with what Python needs of the C header."""

import ast
import json
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import textwrap

from cffi import FFI
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

COMMENT = re.compile(r"/\*\*(.*?)\*/", re.DOTALL)
TYPE = re.compile(r"/\*\*((?:(?!\*/).)*)\*/\ntypedef (?:enum|struct) rayc_(\w+) {\n(.*?)\n}", re.DOTALL)
MEMBER = re.compile(r"/\*\*((?:(?!\*/).)*)\*/\s*([^,;]+?)[,;]", re.DOTALL)
NUMBERS = {"double": "float", "uint32_t": "int"}
HEAD_OF_MODULE = '''"""Constants, enums and options of raycontact.h, from which this file is generated."""

from enum import EnumMeta, IntEnum
from typing import TYPE_CHECKING, Union


# help() shows what dir() lists: what an enum or a kind of options has of its own, not what every int or dict can do.
class Named(EnumMeta):
    def __dir__(cls) -> list[str]:
        return ["__doc__", *cls.__members__]


if TYPE_CHECKING:
    from typing import TypedDict as Options
else:

    class Names(type):
        def __new__(kind, name, bases, body, total=True):
            return super().__new__(kind, name, bases, body)

        def __call__(cls, **given):
            return given

        def __dir__(cls):
            return ["__doc__", "__annotations__"]

    Options = Names("Options", (), {})
'''


class LibraryHook(BuildHookInterface):
    """One wheel serves every CPython of a platform: nothing in it is compiled against Python."""

    def initialize(self, version, build_data):
        if version == "editable":
            sys.exit("a part of the package is made with the wheel: use 'pip install .' without -e")
        root = pathlib.Path(self.root)
        library = build_library(root)
        headers = read_headers(root / "include/raycontact.h")
        ffi = FFI()
        for header in headers:
            ffi.cdef(declarations(header))
        ffi.set_source("raycontact._ffi", None)
        generated = root / "target/python"
        generated.mkdir(parents=True, exist_ok=True)
        ffi.emit_python_code(str(generated / "_ffi.py"))
        (generated / "_header.py").write_text(types("\n".join(headers), library.name), encoding="utf-8")

        files = [library, generated / "_ffi.py", generated / "_header.py"]
        build_data["force_include"].update({str(file): f"raycontact/{file.name}" for file in files})
        platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
        build_data.update(pure_python=False, tag=f"py3-none-{platform}")


def build_library(root):
    """The shared library that cargo makes, or has made: the release build of every other part of the repository."""
    command = "cargo build --release --lib --locked --message-format=json-render-diagnostics".split()
    if not shutil.which("cargo"):
        sys.exit("cargo is missing: install a Rust toolchain (https://rustup.rs) and put it on the PATH")
    told = subprocess.run(command, cwd=root, stdout=subprocess.PIPE, encoding="utf-8")
    if told.returncode:
        sys.exit("cargo could not build the library: what it says stands above")
    for message in map(json.loads, told.stdout.splitlines()):
        if message["reason"] == "compiler-artifact" and message["target"]["name"] == "raycontact":
            files = map(pathlib.Path, message["filenames"])
            return next(file for file in files if file.suffix in (".so", ".dylib", ".dll"))
    raise FileNotFoundError("cargo has told of no shared library")


def read_headers(whole):
    """What it includes, in that order: each header stands below those that it needs."""
    names = re.findall(r'^#include "(.*)"$', whole.read_text(encoding="utf-8"), re.MULTILINE)
    return [(whole.parent / name).read_text(encoding="utf-8") for name in names]


def declarations(header):
    """A header without comments and what stands for other compilers, as cffi reads it."""
    code = re.sub(r"//.*", "", COMMENT.sub("", header))
    lines = (line.strip() for line in code.splitlines() if not line.startswith("#"))
    return "\n".join(lines).replace('extern "C" {\n', "").rstrip("\n}")


def types(header, library):
    """A module with the header's constants, enums and options, for people, editors and type checkers."""
    parts = [f'{HEAD_OF_MODULE}\nLIBRARY = "{library}"']
    for name, value in re.findall(r"^#define RAYC_(\w+) (\S+)$", header, re.MULTILINE):
        parts.append(f"{name} = {2**32 - 1 if value == 'UINT32_MAX' else ast.literal_eval(value)}")
    names = re.findall(r"^typedef enum rayc_(\w+)", header, re.MULTILINE)
    enums = {}
    for text, name, body in TYPE.findall(header):
        members = [(plain(text), *member.rsplit(" ", 1)) for text, member in MEMBER.findall(body + ",")]
        if name.endswith("_options"):
            settable = [member for member in members if member[1] in NUMBERS and member[2] != "reserved"]
            known = [(member, f": {NUMBERS[kind]}", text) for text, kind, member in settable]
            for place, (member, _, told) in enumerate(known):
                if named := re.search(r"\b[Aa] rayc_(\w+)", told):
                    enums[member] = title(named[1])
                    known[place] = member, ": Union[int, str]", told
            parts.append(class_of(f"{title(name)}(Options, total=False)", text, known))
        elif "=" in members[0][1]:
            prefix = len(f"rayc_{name}_")
            known = [(member[prefix:-2], f" = {value}", text) for text, member, value in members]
            parts.append(class_of(f"{title(name)}(IntEnum, metaclass=Named)", text, known))
    by_name = ", ".join(f'"{member}": {enum}' for member, enum in enums.items())
    parts.append(f"\n\n# The enums of options, which may be given by name.\nENUMS = {{{by_name}}}")
    public = re.findall(r"^class (\w+)", "".join(parts[1:]), re.MULTILINE)
    parts.append(f'\n\n__all__ = {["NO_TRIANGLE", *public]}')
    text = "\n".join(parts) + "\n"
    # Enums and their members as they are called here.
    for name in names:
        text = re.sub(rf"\brayc_{name}\b", title(name), text)
        text = re.sub(rf"\bRAYC_{name.upper()}_(?=[A-Z])", f"{title(name)}.", text)
    return text


def title(name):
    return name.title().replace("_", "")


def class_of(head, text, members):
    """Members are told of in the text of the class, since help() shows no others."""
    told = [f"{name}:\n{textwrap.indent(text, '    ')}" for name, _, text in members]
    lines = ['"""' + "\n\n".join([plain(text), *told]) + '\n"""', "", *(name + value for name, value, _ in members)]
    return f"\n\nclass {head}:\n" + textwrap.indent("\n".join(lines), "    ")


def plain(comment):
    text = re.sub(r"^ *\* ?", "", comment, flags=re.MULTILINE).strip()
    text = text.replace("rayc_last_error_message()", "the text of Error")
    return re.sub(r" Fill with rayc_default_\w+\(\), then change what you need\.", "", text)
