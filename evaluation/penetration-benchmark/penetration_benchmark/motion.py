# SPDX-License-Identifier: MIT OR Apache-2.0
"""The one rule by which bodies move in the task free: no masses, no velocities, the same for all libraries."""

import numpy as np

MOST_STEPS = 100
# How many steps in which neither body moves make it stuck: a library may wait before it acts.
MOST_STILL_STEPS = 30
# How much a motion costs beside the contacts' weights.
INERTIA = 0.05
# The longest way of any point in one step, in the body's size.
LONGEST_STEP = 0.1
# How far beyond mere touching the bodies are moved, in the smaller one's size.
CLEARANCE = 1e-3
# Further than this from its start, in its sizes, a body has exploded.
FARTHEST = 10.0


class Body:
    """size is the longest side of its box, centre its middle, radius the way from there to the farthest vertex."""

    def __init__(self, surface, placement):
        low, high = surface.positions.min(0), surface.positions.max(0)
        self.middle, self.size = (low + high) / 2, (high - low).max()
        self.rest = surface.positions - self.middle
        self.radius = np.linalg.norm(self.rest, axis=1).max()
        self.rotation = placement[:, :3].copy()
        self.centre = self.rotation @ self.middle + placement[:, 3]

    def placement(self):
        return np.column_stack([self.rotation, self.centre - self.rotation @ self.middle])

    def positions(self):
        return self.rest @ self.rotation.T + self.centre


def step(bodies, contacts):
    """Minimises Σ weight (J q − depth − clearance)² + 0.05 Σ weight |q|² over a shift and a turn of each body, turns
    counted by the way of the farthest vertex, and moves them by q, shortened where it leads beyond the longest step.
    Returns the longest way, in sizes."""
    contacts = contacts[contacts["weight"] > 0]
    if not len(contacts):
        return 0.0
    rows = []
    for body, points, sign in ((bodies[0], contacts["first"], 1), (bodies[1], contacts["second"], -1)):
        along = sign * contacts["direction"]
        rows += [along, np.cross(points - body.centre, along) / body.radius]
    rows, weights = np.hstack(rows), contacts["weight"] / contacts["weight"].sum()
    wanted = contacts["depth"] + CLEARANCE * min(body.size for body in bodies)
    matrix = rows.T @ (weights[:, None] * rows) + INERTIA * np.eye(12)
    q = np.linalg.solve(matrix, rows.T @ (weights * wanted)).reshape(2, 2, 3)
    longest = 0.0
    for body, (shift, turn) in zip(bodies, q):
        way = (np.linalg.norm(shift) + np.linalg.norm(turn)) / body.size
        share = min(1.0, LONGEST_STEP / way) if way > 0 else 0.0
        longest = max(longest, way * share)
        body.centre = body.centre + shift * share
        body.rotation = orthonormal(rotation(turn * share / body.radius) @ body.rotation)
    return longest


def rotation(vector):
    """About a vector, by as many radians as it is long."""
    angle = np.linalg.norm(vector)
    if angle == 0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def orthonormal(matrix):
    x = matrix[0] / np.linalg.norm(matrix[0])
    y = matrix[1] - x * (x @ matrix[1])
    y /= np.linalg.norm(y)
    return np.array([x, y, np.cross(x, y)])


def free(library, surfaces, pose, are_apart, found):
    """(outcome, steps, way, bodies): freed, stuck or exploded; the way is the sum of each step's longest, in sizes."""
    bodies = [Body(surface, placement) for surface, placement in zip(surfaces, pose.placements())]
    starts, way, still = [body.centre for body in bodies], 0.0, 0
    for steps in range(MOST_STEPS + 1):
        positions = tuple(body.positions() for body in bodies)
        if are_apart(positions):
            return "freed", steps, way, bodies
        library.move(np.stack([body.placement() for body in bodies]), positions)
        moved = step(bodies, found(library.contacts()))
        way += moved
        still = still + 1 if moved < 1e-12 else 0
        if still >= MOST_STILL_STEPS:
            break
        if any(not np.linalg.norm(body.centre - start) < FARTHEST * body.size for body, start in zip(bodies, starts)):
            return "exploded", steps, way, bodies
    return "stuck", MOST_STEPS, way, bodies
