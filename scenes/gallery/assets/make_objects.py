"""Writes the meshes of objects.json beside itself: python3 make_objects.py (needs numpy)."""

from pathlib import Path

import numpy as np

from mesh import Mesh, about

HERE = Path(__file__).parent


def ring():
    """A torus that leans."""
    turn = np.linspace(2 * np.pi, 0, 49)
    around = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    rows = [[((0.3 + 0.11 * np.cos(a)) * np.cos(t), (0.3 + 0.11 * np.cos(a)) * np.sin(t), 0.11 * np.sin(a)) for a in around] for t in turn]
    points = np.array(rows) @ (about((0, 1, 0), 35) @ about((1, 0, 0), -35)).T
    return Mesh().grid(points - (0, points[..., 1].min(), 0), closed=True)


def cone():
    """A cone with a rounded tip."""
    return Mesh().lathe([(0.34, 0), (0.02, 0.98), (0.012, 0.995), (0, 1)], sides=48)


def gem():
    """An icosahedron on one of its faces."""
    golden = (1 + 5**0.5) / 2
    corners = [p for a in (-1, 1) for b in (-golden, golden) for p in ((0, a, b), (a, b, 0), (b, 0, a))]
    corners, mesh = np.array(corners) * 0.19, Mesh()
    near = [[j for j in range(12) if 0 < np.linalg.norm(corners[i] - corners[j]) < 0.4] for i in range(12)]
    faces = {tuple(sorted((i, j, k))) for i in range(12) for j in near[i] for k in near[i] if k in near[j]}
    normal = corners[list(min(faces))].sum(0)
    normal /= np.linalg.norm(normal)
    axis = np.cross(normal, (0, -1, 0))
    turn = about(axis / np.linalg.norm(axis), np.degrees(np.arccos(-normal[1])))
    corners = corners @ turn.T
    for i, j, k in faces:
        a, b, c = corners[[i, j, k]]
        mesh.face(a, b, c) if np.cross(b - a, c - a) @ a > 0 else mesh.face(a, c, b)
    mesh.points = [points - (0, corners[:, 1].min(), 0) for points in mesh.points]
    return mesh


def frosted():
    """A vase of solid glass: no hollow."""
    profile = [(0, 0), (0.2, 0), (0.22, 0.01), (0.27, 0.16), (0.24, 0.36), (0.14, 0.54), (0.12, 0.62), (0.16, 0.72), (0.15, 0.73), (0, 0.73)]
    mesh = Mesh().lathe(smooth(profile[2:-2]), sides=48)
    for flat in (profile[:2], profile[1:3], profile[-3:-1], profile[-2:]):
        mesh.lathe(flat, sides=48)
    return mesh


def smooth(profile, n=32):
    """A curve through the points, by cubic pieces (Catmull and Rom)."""
    p = np.array([profile[0]] + profile + [profile[-1]])
    t = np.linspace(0, len(profile) - 1, n)
    i = np.minimum(t.astype(int), len(profile) - 2)
    f = (t - i)[:, None]
    a, b, c, d = p[i], p[i + 1], p[i + 2], p[i + 3]
    return 0.5 * (2 * b + (c - a) * f + (2 * a - 5 * b + 4 * c - d) * f**2 + (3 * b - a - 3 * c + d) * f**3)


def shade():
    """A lamp's shade and its cord; the bulb is at the origin."""
    outside = [(0.26, -0.21), (0.245, -0.12), (0.2, 0.0), (0.13, 0.11), (0.06, 0.16), (0.045, 0.2), (0.04, 0.28), (0.0, 0.29)]
    return Mesh().lathe(smooth(outside), sides=48).tube([(0, 0.3, 0), (0, 1.2, 0)], 0.008)


if __name__ == "__main__":
    for make in (ring, cone, gem, frosted, shade):
        make().write(HERE / f"objects_{make.__name__}.ply")
