# SPDX-License-Identifier: MIT OR Apache-2.0
"""Contact between deformable bodies, found by tracing rays: raycontact's C interface with numpy arrays.

One step of a simulation: Scene.set_positions() for each body that moved, Scene.query(), Contacts.add_forces(),
Scene.advance(). Lengths are in any one unit, metres in these texts; triangles are counter-clockwise seen from outside.

Arrays of n vectors have the shape (n, 3). In float32 or float64, with the three numbers of a row side by side and rows
in ascending order (slices of rows and of wider arrays too), they are used where they lie. Others are copied, or refused
where they are to be written to. The library keeps no pointer to an array. Arrays that it returns own their memory: they
stay valid when meshes, scenes and contacts are gone.

Options are keyword arguments with the names of the C header. What is not given has its default; flags may be bools, and
enums their names, such as sampling="vertices". Every call lets other Python threads run. Two of them must not use one
scene, mesh or list of contacts at once where one changes it: that raises Error with Status.BUSY."""

from . import _header
from ._header import *  # noqa: F403 (constants, enums and options of the C header)
from ._library import Error, paper_detection_options
from .contact_system import Batch, ContactSystem, Material
from .mesh import Mesh
from .scene import Contacts, Scene, query_pair, query_self

__version__ = f"{_header.VERSION_MAJOR}.{_header.VERSION_MINOR}.{_header.VERSION_PATCH}"
__all__ = ["Batch", "ContactSystem", "Contacts", "Error", "Material", "Mesh", "Scene"]
__all__ += ["paper_detection_options", "query_pair", "query_self", *_header.__all__]
