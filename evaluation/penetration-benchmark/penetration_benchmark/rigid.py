# SPDX-License-Identifier: MIT OR Apache-2.0
"""The integrator of the task simulate: rigid bodies, a library's contacts as springs and dampers, the same for all."""

import numpy as np

from .motion import orthonormal, rotation

# All contacts together are one spring, in which a body would swing by this time for a radian...
SWING = 0.02
# ...and one damper, that of a swing that just fails to come back. A part of it acts along the surfaces.
DAMPING = 2 * SWING
SIDEWAYS = 1.0
# How often rows that pull are taken out or put back.
MOST_ROUNDS = 20


def integrals(positions, triangles):
    """Volume, centre and second moments about the centre of a closed surface: exact sums over its triangles, each with
    the origin as a tetrahedron."""
    middle = positions.mean(0)
    corners = (positions - middle)[triangles]
    sixfold = np.einsum("ti,ti->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    sums = corners.sum(1)
    volume = sixfold.sum() / 6
    centre = np.einsum("t,ti->i", sixfold, sums) / 24 / volume
    moments = (np.einsum("t,tvi,tvj->ij", sixfold, corners, corners)
               + np.einsum("t,ti,tj->ij", sixfold, sums, sums)) / 120
    return volume, centre + middle, moments - volume * np.outer(centre, centre)


class RigidBody:
    """Of density 1. velocity: of the centre of mass, and the spin, which stays as it is in flight: no gyroscopic torque,
    so that flight keeps the energy exactly."""

    def __init__(self, surface, placement, velocity=(0, 0, 0), is_fixed=False):
        self.mass, self.middle, moments = integrals(surface.positions, surface.triangles)
        self.inertia = np.trace(moments) * np.eye(3) - moments
        self.rest, self.is_fixed = surface.positions - self.middle, is_fixed
        self.size = np.ptp(surface.positions, axis=0).max()
        self.radius = np.linalg.norm(self.rest, axis=1).max()
        self.rotation = placement[:, :3].copy()
        self.centre = self.rotation @ self.middle + placement[:, 3]
        self.velocity = np.array([*velocity, 0, 0, 0], float)

    def placement(self):
        return np.column_stack([self.rotation, self.centre - self.rotation @ self.middle])

    def positions(self):
        return self.rest @ self.rotation.T + self.centre

    def masses(self):
        matrix = self.mass * np.eye(6)
        matrix[3:, 3:] = self.rotation @ self.inertia @ self.rotation.T
        return matrix

    def energy(self, gravity):
        """Of motion and height."""
        return 0.0 if self.is_fixed else (0.5 * self.velocity @ self.masses() @ self.velocity
                                          - self.mass * gravity @ self.centre)

    def speed(self):
        """No point is faster."""
        return np.linalg.norm(self.velocity[:3]) + self.radius * np.linalg.norm(self.velocity[3:])

    def move(self, time_step):
        self.centre = self.centre + time_step * self.velocity[:3]
        self.rotation = orthonormal(rotation(time_step * self.velocity[3:]) @ self.rotation)


def stiffness(bodies):
    return 1 / sum(1 / body.mass for body in bodies if not body.is_fixed) / SWING**2


def rows(bodies, points, directions):
    """How fast the points of the two bodies part along directions, (k, 6 for each moving body)."""
    columns = []
    for body, own, sign in zip(bodies, points, (1, -1)):
        if not body.is_fixed:
            columns += [sign * directions, np.cross(own - body.centre, sign * directions)]
    return np.hstack(columns)


def step(bodies, contacts, time_step, gravity):
    """One step of implicit Euler: each contact pushes with its part of the stiffness times (depth − (time step + DAMPING)
    · speed of parting) at the end of the step, and never pulls."""
    moving = [body for body in bodies if not body.is_fixed]
    masses = np.zeros((6 * len(moving), 6 * len(moving)))
    for i, body in enumerate(moving):
        masses[6 * i:6 * i + 6, 6 * i:6 * i + 6] = body.masses()
        body.velocity[:3] += time_step * gravity
    velocity = np.concatenate([body.velocity for body in moving])
    contacts = contacts[contacts["weight"] > 0]
    if len(contacts):
        velocity = solve(bodies, contacts, time_step, masses, velocity)
    for body, own in zip(moving, velocity.reshape(-1, 6)):
        body.velocity = own.copy()
        body.move(time_step)


def solve(bodies, contacts, time_step, masses, velocity):
    """The velocities at the end of the step."""
    springs = stiffness(bodies) * contacts["weight"] / contacts["weight"].sum()
    ways, depths = contacts["direction"], contacts["depth"]
    normal = rows(bodies, (contacts["first"], contacts["second"]), ways)
    # Both act at one point between, so that bodies which turn as one are not braked.
    middle = 0.5 * (contacts["first"] + contacts["second"])
    aside = [rows(bodies, (middle, middle), axis - ways[:, i:i + 1] * ways) for i, axis in enumerate(np.eye(3))]
    everything = np.vstack([normal, *aside])
    factors = time_step * np.repeat([time_step + DAMPING, *[DAMPING] * 3], len(ways)) * np.tile(springs, 4)
    pushes, momentum = np.ones(len(ways), bool), masses @ velocity
    for _ in range(MOST_ROUNDS):
        matrix = masses + everything.T @ ((factors * np.tile(pushes, 4))[:, None] * everything)
        velocity = np.linalg.solve(matrix, momentum + time_step * normal.T @ (springs * depths * pushes))
        before, pushes = pushes, depths > (time_step + DAMPING) * (normal @ velocity)
        if (pushes == before).all():
            break
    return velocity
