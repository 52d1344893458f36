# SPDX-License-Identifier: MIT OR Apache-2.0
import os

from ..c_library import CLibrary


class ShortestPath(CLibrary):
    name = "Chen and others 2023 on Embree"
    version = "3.13.5"
    settings = "rebuilt from the paper: tetrahedra, feasible regions, straight paths; trees refitted in each step"
    documentation = "https://doi.org/10.1145/3592136"
    tasks = ("self",)

    def __init__(self):
        super().__init__(os.path.join(os.environ["PENETRATION_BUILD"], "shortest_path.so"))
