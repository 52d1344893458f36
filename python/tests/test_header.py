# SPDX-License-Identifier: MIT OR Apache-2.0
"""The package is held to the C headers, which are read anew with each build."""

import pathlib
import pydoc
import re

import pytest
import raycontact
from raycontact import _header, _library
from raycontact._ffi import ffi

ROOT = pathlib.Path(__file__).parents[2]
INCLUDES = re.findall(r'^#include "(.*)"$', (ROOT / "include/raycontact.h").read_text(encoding="utf-8"), re.MULTILINE)
HEADERS = "\n".join((ROOT / "include" / name).read_text(encoding="utf-8") for name in INCLUDES)
CODE = re.sub(r"/\*\*.*?\*/", "", HEADERS, flags=re.DOTALL)

# What stays out besides distributed.h, of which raycontact/mpi.hpp is made, and why.
LEFT_OUT = {
    "rayc_abi_version": "the library is in the same wheel",
    "rayc_contact_system_off_course": "rayc_contact_system_detect_again looks where it has to",
    "rayc_contact_system_set_added_inertia": "engines with joints are asked for it from C++, as Bullet is",
    "rayc_octree_trace_ray": "rayc_octree_trace_rays takes one too",
    "rayc_status_name": "Status has the names",
    "rayc_version": "the header of this build has it",
}


def test_every_function_can_be_reached():
    functions = set(re.findall(r"\b(rayc_\w+)\(", CODE))
    assert len(functions) > 50
    sources = "".join(file.read_text(encoding="utf-8") for file in (ROOT / "python/raycontact").glob("*.py"))
    called = set(re.findall(r"library\.(rayc_\w+)", sources))
    kinds = set(re.findall(r'create\(\s*"(\w+)"', sources))
    called |= {f"rayc_{kind}_{end}" for kind in kinds for end in ("create", "destroy")}
    called |= {f"rayc_{kind}_{way}" for kind in kinds for way in re.findall(r'way="(\w+)"', sources)}
    called |= {f"rayc_default_{kind}_options" for kind in re.findall(r'options\("(\w+)"', sources)}
    of_either_type = re.findall(r'(?:call_for|_ask)\("(\w+)"', sources)
    called |= {f"rayc_contact_system_{name}{end}" for name in of_either_type for end in ("", "_f32")}
    called |= {f"rayc_contact_systems_{name}" for name in re.findall(r'_call\("(\w+)"', sources)}
    assert functions - called == set(LEFT_OUT)
    for function in functions:
        getattr(_library.library, function)  # is in the library


@pytest.mark.parametrize("kind", ["mesh", "detection", "response", "scene", "contact_system", "octree"])
def test_options_are_those_of_the_header(kind):
    fields = {name for name, _ in ffi.typeof(f"rayc_{kind}_options").fields}
    known = getattr(_header, f"{kind.title().replace('_', '')}Options").__annotations__
    # Python calls cannot be lent to the library's threads.
    assert fields - set(known) <= {"struct_size", "reserved", "parallel_for", "parallel_context"}
    assert set(known) <= fields


def test_enums_are_those_of_the_header():
    enums = re.findall(r"typedef enum rayc_(\w+) {(.*?)}", CODE, re.DOTALL)
    assert len(enums) >= 5
    for name, body in enums:
        members = {member: int(value) for member, value in re.findall(r"RAYC_(\w+) = (\d+)", body)}
        enum = getattr(raycontact, name.title().replace("_", ""))
        assert {f"{name.upper()}_{member.name}": member.value for member in enum} == members


def test_what_is_generated_says_what_the_header_says():
    assert raycontact.NO_TRIANGLE == 2**32 - 1
    major, minor, patch = map(int, raycontact.__version__.split("."))
    assert 10_000 * major + 100 * minor + patch == _library.library.rayc_version()
    assert raycontact.DetectionOptions.__doc__.startswith("How contacts are found.\n")
    for kind in (
        raycontact.MeshOptions,
        raycontact.DetectionOptions,
        raycontact.ResponseOptions,
        raycontact.SceneOptions,
        raycontact.ContactSystemOptions,
    ):
        for name in kind.__annotations__:
            assert re.search(rf"^ *{name}:\n +\S", kind.__doc__, re.MULTILINE), name
    assert "Pressure by depth below the surface" in raycontact.Law.__doc__
    assert "Where rays start, a Sampling. Default Sampling.ACCURACY." in raycontact.DetectionOptions.__doc__


def test_every_public_name_is_documented():
    for name in raycontact.__all__:
        thing = getattr(raycontact, name)
        if not isinstance(thing, (int, float)):
            assert thing.__doc__, name
    for kind in (raycontact.Contacts, raycontact.ContactSystem, raycontact.Mesh, raycontact.Scene):
        for name, thing in vars(kind).items():
            assert name.startswith("_") or thing.__doc__, f"{kind.__name__}.{name}"


def test_help_leaves_out_what_every_int_dict_and_tuple_can_do():
    told = pydoc.plain(pydoc.render_doc(raycontact))
    assert not re.search(r"inherited from (builtins\.)?(int|dict|tuple)\b", told)
    for text in ("PRESSURE = <Law.PRESSURE: 0>", "sampling_value:", "damping_time"):
        assert text in told
    assert raycontact.DetectionOptions(edges=1) == {"edges": 1}


def test_the_package_stays_small():
    """What is of our own: docstrings and type hints count, blank lines do not."""
    texts = [file.read_text(encoding="utf-8") for file in (ROOT / "python/raycontact").glob("*.py")]
    assert sum(bool(line.strip()) for text in texts for line in text.splitlines()) <= 600
