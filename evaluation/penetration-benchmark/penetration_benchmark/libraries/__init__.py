# SPDX-License-Identifier: MIT OR Apache-2.0
"""The libraries that have been measured, each at the settings that did best of those tried."""

import importlib

# Module and class, in the order of the tables.
KNOWN = {
    "raycontact": ("raycontact_library", "Raycontact"),
    "raycontact-paper": ("raycontact_library", "RaycontactPaper"),
    "raycontact-no-escape": ("raycontact_library", "RaycontactNoEscape"),
    "raycontact-own-exits": ("raycontact_own_exits", "RaycontactOwnExits"),
    "embree": ("embree", "Embree"),
    "embree-4": ("embree", "Embree4"),
    "shortest-path": ("shortest_path", "ShortestPath"),
    "trimesh": ("trimesh_library", "Trimesh"),
    "fcl": ("fcl_library", "Fcl"),
    "coal": ("coal_library", "Coal"),
    "coal-patches": ("coal_library", "CoalPatches"),
    "bullet": ("bullet", "Bullet"),
    "mujoco": ("mujoco_library", "Mujoco"),
    "drake": ("drake", "Drake"),
    "ipc-toolkit": ("ipc_toolkit", "IpcToolkit"),
}


def make(name):
    """Raises ImportError or OSError where the library is not installed."""
    module, kind = KNOWN[name]
    return getattr(importlib.import_module(f".{module}", __name__), kind)()
