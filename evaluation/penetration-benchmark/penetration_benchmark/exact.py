# SPDX-License-Identifier: MIT OR Apache-2.0
"""The judge: which points are inside a surface, and whether two surfaces meet, decided without rounding.

Signs of determinants are taken from doubles where these are larger than their error bound (Shewchuk 1997), and computed
anew in integers where they are not.
"""

import numpy as np

EPSILON = 2.0**-53
BOUND_2D = (3 + 16 * EPSILON) * EPSILON
BOUND_3D = (7 + 56 * EPSILON) * EPSILON
# How many edges and triangles are looked at before all the others.
FIRST = 64
# How many places where bodies met are tried first.
REMEMBERED = 12


def signs(values, bounds, exactly):
    """The signs of determinants; exactly(i) gives the i-th where rounding might decide."""
    found = np.sign(values).astype(np.int8)
    for i in np.flatnonzero(np.abs(values) <= bounds):
        exact = exactly(i)
        found[i] = (exact > 0) - (exact < 0)
    return found


def integers(*points):
    """Coordinates times the power of two that makes integers of them all, which leaves signs of determinants alone."""
    ratios = [[x.as_integer_ratio() for x in point.tolist()] for point in points]
    scale = max(denominator for point in ratios for _, denominator in point)
    return [[numerator * (scale // denominator) for numerator, denominator in point] for point in ratios]


def side_of_line(a, b, c):
    """Of points in the plane, (n, 2) each: 1 where a, b, c turn to the left, −1 to the right, 0 on one line."""
    left = (a[:, 0] - c[:, 0]) * (b[:, 1] - c[:, 1])
    right = (a[:, 1] - c[:, 1]) * (b[:, 0] - c[:, 0])

    def exactly(i):
        (ax, ay), (bx, by), (cx, cy) = integers(a[i], b[i], c[i])
        return (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)

    return signs(left - right, BOUND_2D * (np.abs(left) + np.abs(right)), exactly)


def side_of_plane(a, b, c, d, is_exact=True):
    """Of points, (n, 3) each: 1 where a, b, c are counter-clockwise seen from d, −1 clockwise, 0 in one plane, and if not
    is_exact, where rounding might decide."""
    u, v, w = a - d, b - d, c - d

    def sum_of_products(combine):
        return sum(r[:, 2] * combine(s[:, 0] * t[:, 1], s[:, 1] * t[:, 0]) for r, s, t in
                   ((u, v, w), (v, w, u), (w, u, v)))

    value = -sum_of_products(np.subtract)
    u, v, w = np.abs(u), np.abs(v), np.abs(w)
    bound = BOUND_3D * sum_of_products(np.add)
    # Two points that are the same: nothing was rounded.
    bound[~(u.any(1) & v.any(1) & w.any(1))] = -1

    if not is_exact:
        return np.where(np.abs(value) > bound, np.sign(value), 0).astype(np.int8)
    return signs(value, bound, lambda i: side(*integers(a[i], b[i], c[i], d[i])))


def side(a, b, c, d):
    """Of one point, in integers: any number with the sign that side_of_plane has."""
    (ux, uy, uz), (vx, vy, vz), (wx, wy, wz) = ([x - y for x, y in zip(corner, d)] for corner in (a, b, c))
    return -(uz * (vx * wy - vy * wx) + vz * (wx * uy - wy * ux) + wz * (ux * vy - uy * vx))


def classify(points, positions, triangles, chunk=2_000_000):
    """1 for points inside the closed surface, −1 outside, 0 on it (or where every way out meets an edge)."""
    corners = positions[triangles]
    low, high = corners.min(1), corners.max(1)
    found = np.full(len(points), -1, np.int8)
    open_points = np.flatnonzero(((points >= low.min(0)) & (points <= high.max(0))).all(1))
    for axis in range(3):
        if not len(open_points):
            return found
        result = [ray_parity(points[part], corners, low, high, axis)
                  for part in np.array_split(open_points, 1 + len(open_points) * len(corners) // chunk)]
        result = np.concatenate(result)
        found[open_points] = result
        open_points = open_points[result == 0]
    for i in open_points:
        found[i] = slanted_parity(points[i], corners)
    return found


def ray_parity(points, corners, low, high, axis):
    """By the crossings along one axis; 0 where the way meets an edge, or the point lies on a triangle."""
    plane = [(axis + 1) % 3, (axis + 2) % 3]
    is_near = (points[:, None, axis] <= high[:, axis])
    for other in plane:
        is_near &= (points[:, None, other] >= low[:, other]) & (points[:, None, other] <= high[:, other])
    of_point, of_triangle = np.nonzero(is_near)
    p, (a, b, c) = points[of_point], corners[of_triangle].transpose(1, 0, 2)
    turns = np.stack([side_of_line(q[:, plane], r[:, plane], p[:, plane]) for q, r in ((a, b), (b, c), (c, a))])
    is_missed = (turns > 0).any(0) & (turns < 0).any(0)
    is_edge = (turns == 0).any(0) & ~is_missed
    crossed = np.flatnonzero(~is_missed & ~is_edge)
    # The plane is passed beyond the point where the point is below a triangle that faces along the axis, or above one
    # that faces back.
    sides = side_of_plane(a[crossed], b[crossed], c[crossed], p[crossed])
    ahead = crossed[sides == -turns[0, crossed]]
    is_open = np.zeros(len(points), bool)
    is_open[of_point[is_edge]] = True
    is_open[of_point[crossed[sides == 0]]] = True
    count = np.bincount(of_point[ahead], minlength=len(points))
    return np.where(is_open, 0, np.where(count % 2 == 1, 1, -1)).astype(np.int8)


def slanted_parity(point, corners):
    a, b, c = corners.transpose(1, 0, 2)
    at = np.broadcast_to(point, a.shape)
    reach = 4 * np.abs(corners - point).max()
    for attempt in range(16):
        slant = 0.01 + 0.0137 * attempt
        to = np.broadcast_to(point + reach * np.array([1.0, slant, 0.618 * slant]), a.shape)
        here, there = side_of_plane(a, b, c, at), side_of_plane(a, b, c, to)
        turns = np.stack([side_of_plane(at, to, q, r) for q, r in ((a, b), (b, c), (c, a))])
        is_met = (here * there <= 0) & ~((turns > 0).any(0) & (turns < 0).any(0))
        if (is_met & (here == 0)).any():
            return 0
        if not (is_met & ((there == 0) | (turns == 0).any(0))).any():
            return 1 if is_met.sum() % 2 else -1
    return 0


def edges_of(triangles):
    """Each once."""
    pairs = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return np.unique(pairs, axis=0)


def edges_meet(positions, edges, other, triangles):
    """An edge and a triangle of another surface that have a point in common, by their numbers; None if none have."""
    low, high = np.maximum(positions.min(0), other.min(0)), np.minimum(positions.max(0), other.max(0))
    (ends, edge_numbers), (corners, triangle_numbers) = within(positions[edges], low, high), within(
        other[triangles], low, high)
    if not len(ends) or not len(corners):
        return None
    is_near = np.ones((len(ends), len(corners)), bool)
    for axis in range(3):
        is_near &= ends[:, :, axis].min(1)[:, None] <= corners[:, :, axis].max(1)
        is_near &= ends[:, :, axis].max(1)[:, None] >= corners[:, :, axis].min(1)
    of_edge, of_triangle = np.nonzero(is_near)
    (p, q), (a, b, c) = ends[of_edge].transpose(1, 0, 2), corners[of_triangle].transpose(1, 0, 2)
    pairs = edge_numbers[of_edge], triangle_numbers[of_triangle]
    met = first_pierced(p, q, a, b, c)
    # Where all is in doubt, some of the first few mostly meet.
    for part in (slice(0, FIRST), slice(FIRST, None)):
        if met is None:
            met = first_met(*(x[part] for x in (p, q, a, b, c)))
            met = None if met is None else met + part.start
    return None if met is None else (pairs[0][met], pairs[1][met])


def first_pierced(p, q, a, b, c):
    """The number of a segment p q that surely passes through its triangle a b c, (n, 3) each; None if there is none."""
    apart = np.flatnonzero(side_of_plane(a, b, c, p, False) * side_of_plane(a, b, c, q, False) < 0)
    p, q, a, b, c = (x[apart] for x in (p, q, a, b, c))
    turns = np.stack([side_of_plane(p, q, r, s, False) for r, s in ((a, b), (b, c), (c, a))])
    pierced = apart[np.abs(turns.sum(0)) == 3]
    return pierced[0] if len(pierced) else None


def first_met(p, q, a, b, c):
    """The number of the first segment p q that has a point in common with its triangle a b c; None if none has."""
    here, there = side_of_plane(a, b, c, p), side_of_plane(a, b, c, q)
    left = np.flatnonzero(here * there <= 0)
    p, q, a, b, c, here, there = (x[left] for x in (p, q, a, b, c, here, there))
    turns = np.stack([side_of_plane(p, q, r, s) for r, s in ((a, b), (b, c), (c, a))])
    is_flat = (here == 0) & (there == 0)
    is_met = ~is_flat & ~((turns > 0).any(0) & (turns < 0).any(0))
    for i in np.flatnonzero(is_met | is_flat):
        if is_met[i] or meet_in_plane(p[i], q[i], (a[i], b[i], c[i])):
            return left[i]
    return None


def crosses(p, q, a, b, c):
    """Whether one segment passes through one triangle, not within its plane."""
    p, q, a, b, c = integers(p, q, a, b, c)
    here, there = side(a, b, c, p), side(a, b, c, q)
    if here * there > 0 or (here == 0 and there == 0):
        return False
    turns = side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)
    return not (any(turn > 0 for turn in turns) and any(turn < 0 for turn in turns))


def within(elements, low, high):
    """Those whose boxes meet a box, and their numbers."""
    numbers = np.flatnonzero((elements.min(1) <= high).all(1) & (elements.max(1) >= low).all(1))
    return elements[numbers], numbers


def meet_in_plane(p, q, corners):
    """All in one plane: apart only if a line along the segment or an edge has them on its two sides, or a box has."""
    for axis in range(3):
        plane = [(axis + 1) % 3, (axis + 2) % 3]
        p2, q2, *c2 = (x[None, plane] for x in (p, q, *corners))
        along = [int(side_of_line(p2, q2, c)[0]) for c in c2]
        if all(s > 0 for s in along) or all(s < 0 for s in along):
            return False
        for a, b, c in (c2, c2[1:] + c2[:1], c2[2:] + c2[:2]):
            inner = int(side_of_line(a, b, c)[0])
            if inner and all(int(side_of_line(a, b, end)[0]) * inner < 0 for end in (p2, q2)):
                return False
    return True


class Apart:
    """Whether two connected bodies have no point in common. It remembers where they last met: mostly they still do in
    one of those places."""

    def __init__(self, triangles):
        self.triangles, self.edges, self.met = triangles, [edges_of(t) for t in triangles], ()

    def __call__(self, positions):
        (x, y), (t, s) = positions, self.triangles
        if (x.min(0) > y.max(0)).any() or (y.min(0) > x.max(0)).any():
            return True
        for i, (edge, triangle) in self.met:
            if crosses(*positions[i][self.edges[i][edge]], *positions[1 - i][self.triangles[1 - i][triangle]]):
                return False
        for i in (0, 1):
            met = edges_meet(positions[i], self.edges[i], positions[1 - i], self.triangles[1 - i])
            if met:
                self.met = ((i, met), *self.met[:REMEMBERED - 1])
                return False
        # The surfaces do not meet, so each is inside the other with all its vertices or with none.
        return classify(x[:1], y, s)[0] < 0 and classify(y[:1], x, t)[0] < 0
