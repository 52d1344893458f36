# SPDX-License-Identifier: MIT OR Apache-2.0
import importlib.metadata
import os

from ..c_library import CLibrary


class Embree(CLibrary):
    name = "Algorithm 1 on Embree"
    version = "3.13.5"
    settings = "trees refitted in each step, robust traversal, single precision; inside is what has a contact"
    documentation = "https://www.embree.org/api.html"

    def __init__(self):
        super().__init__(os.path.join(os.environ["PENETRATION_BUILD"], "embree.so"))


class Embree4(CLibrary):
    """The library inside embreex. Its contacts are those of the other, so it is timed only."""

    name = "Algorithm 1 on Embree 4"
    version = f"embreex {importlib.metadata.version('embreex')}"
    settings = "as above"
    documentation = Embree.documentation
    tasks = ("detect",)

    def __init__(self):
        super().__init__(os.path.join(os.environ["PENETRATION_BUILD"], "embree4.so"))
