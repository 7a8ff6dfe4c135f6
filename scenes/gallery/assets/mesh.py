"""Triangle meshes from a few primitives, written as binary PLY. Flat faces share no vertices, smooth ones do."""

import numpy as np


def about(axis, degrees):
    """The rotation about a unit axis."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class Mesh:
    """Triangles of one material."""

    def __init__(self):
        self.points, self.faces, self.count = [], [], 0

    def add(self, points, faces):
        """Points that its faces, triples of their indices, share."""
        points = np.asarray(points, float)
        self.points.append(points)
        self.faces.append(np.asarray(faces, int).reshape(-1, 3) + self.count)
        self.count += len(points)
        return self

    def face(self, *corners):
        """A flat convex polygon, counterclockwise from the front."""
        return self.add(corners, [(0, i, i + 1) for i in range(1, len(corners) - 1)])

    def box(self, low, high, turn=None, without=""):
        """A box between two corners, turned about its middle, without the sides named: x, X, y, Y, z, Z (lower, upper)."""
        low, high = np.asarray(low, float), np.asarray(high, float)
        turn, middle = np.eye(3) if turn is None else turn, (low + high) / 2
        corner = [turn @ (np.where(np.array([i & 1, i & 2, i & 4]) > 0, high, low) - middle) + middle for i in range(8)]
        sides = {"x": (0, 4, 6, 2), "X": (1, 3, 7, 5), "y": (0, 1, 5, 4), "Y": (2, 6, 7, 3), "z": (0, 2, 3, 1), "Z": (4, 5, 7, 6)}
        for name, side in sides.items():
            if name not in without:
                self.face(*(corner[i] for i in side))
        return self

    def grid(self, points, closed=False):
        """A smooth surface through rows of points; closed: the last of each row meets the first."""
        points = np.asarray(points, float)
        rows, columns = points.shape[:2]
        last = columns if closed else columns - 1
        faces = []
        for i in range(rows - 1):
            for j in range(last):
                a, b = i * columns + j, i * columns + (j + 1) % columns
                faces += [(a, b, b + columns), (a, b + columns, a + columns)]
        return self.add(points.reshape(-1, 3), faces)

    def lathe(self, profile, at=(0, 0, 0), sides=24):
        """A profile of (radius, height), from below, turned about the vertical through a point."""
        angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
        ring = np.stack([np.cos(angle), np.zeros(sides), -np.sin(angle)], -1)
        return self.grid([np.asarray(at) + r * ring + (0, y, 0) for r, y in profile], closed=True)

    def tube(self, path, radius, sides=10, caps=False):
        """A round rod along a path; radius: one number, or one for each point."""
        path = np.asarray(path, float)
        radius = np.broadcast_to(radius, len(path))
        angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
        rings = []
        for p, along, r in zip(path, np.gradient(path, axis=0), radius):
            along = along / np.linalg.norm(along)
            across = np.cross(along, (1, 0, 0) if abs(along[0]) < 0.7 else (0, 0, 1))
            across /= np.linalg.norm(across)
            up = np.cross(along, across)
            rings.append(p + r * (np.cos(angle)[:, None] * across + np.sin(angle)[:, None] * up))
        if caps:
            self.face(*rings[0][::-1]).face(*rings[-1])
        return self.grid(rings, closed=True)

    def write(self, path):
        """Writes it as a binary PLY file."""
        points, faces = np.concatenate(self.points), np.concatenate(self.faces)
        a, b, c = (points[faces[:, i]] for i in range(3))
        faces = faces[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12]  # those at the poles of a lathe are none
        index = ("ushort", "<u2") if len(points) < 1 << 16 else ("int", "<i4")
        header = (
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(faces)}\nproperty list uchar {index[0]} vertex_indices\nend_header\n"
        )
        rows = np.zeros(len(faces), [("n", "u1"), ("i", index[1], 3)])
        rows["n"], rows["i"] = 3, faces
        with open(path, "wb") as file:
            file.write(header.encode() + points.astype("<f4").tobytes() + rows.tobytes())
        print(f"{path}: {len(faces)} triangles")
