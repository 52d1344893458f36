# SPDX-License-Identifier: MIT OR Apache-2.0
import os

from ..c_library import CLibrary


class Bullet(CLibrary):
    name = "Bullet"
    version = "3.24"
    settings = ("btConvexHullShape, its manifold kept, where both shapes are convex, else btGImpactMeshShape; margin 0.001; "
                "single precision")
    documentation = "https://github.com/bulletphysics/bullet3/tree/master/docs"

    def __init__(self):
        super().__init__(os.path.join(os.environ["PENETRATION_BUILD"], "bullet.so"))
