"""Vault, ribs, stones and brazier of ../fire_in_a_vault.json. Run it in any folder; it needs numpy."""

import numpy as np

from files import FOLDER, hdr, joined, lattice, ply, turned

RADIUS, SPRING, LENGTH = 2.3, 1.7, 12.0
"""Of the vault, and the height at which it begins [m]."""


def section(radius: float, steps: int = 48) -> np.ndarray:
    """Walls and vault across, from the floor on the right to that on the left."""
    angle = np.linspace(0, np.pi, steps)
    arch = np.stack([radius * np.cos(angle), SPRING + radius * np.sin(angle)], -1)
    return np.concatenate([[[radius, 0]], arch, [[-radius, 0]]])


def rib(z: float, deep: float = 0.24, wide: float = 0.36) -> tuple[np.ndarray, np.ndarray]:
    """An arch that stands out from the vault, with its pillars."""
    inner, outer = section(RADIUS - deep), section(RADIUS + 0.05)
    rows = [np.insert(line, 2, depth, axis=1) for line, depth in ((outer, z - wide / 2), (inner, z - wide / 2), (inner, z + wide / 2), (outer, z + wide / 2))]
    return np.concatenate(rows), lattice(4, len(inner))


def stones(seed: int = 4, size: int = 160) -> np.ndarray:
    """Courses of hewn stone, each of a grey of its own, in dark mortar."""
    random = np.random.default_rng(seed)
    y, x = np.mgrid[:size, :size] / size
    course = np.floor(8 * y).astype(int)
    along = 5 * x + 0.5 * (course % 2) + 0.12 * np.sin(9 * course)
    stone = np.floor(along).astype(int) % 5
    grey = random.uniform(0.16, 0.36, (8, 5))[course % 8, stone] * random.uniform(0.85, 1.1, (size, size))
    joint = np.minimum(np.minimum(along % 1, 1 - along % 1) * 1.6, np.minimum(8 * y % 1, 1 - 8 * y % 1))
    return (grey * np.clip(0.35 + joint / 0.09, 0.35, 1))[..., None] * np.array([1.0, 0.93, 0.82])


def barrel_vault() -> None:
    """As a Wavefront file: it has texture coordinates, a unit for 2 m."""
    line = section(RADIUS, 40)
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    rows = [[f"v {x:.4f} {y:.4f} {z}", f"vt {z / 2:.4f} {u / 2:.4f}"] for z in (-LENGTH / 2, LENGTH / 2) for (x, y), u in zip(line, along)]
    faces = [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in lattice(2, len(line)) + 1]
    (FOLDER / "fire_in_a_vault.obj").write_text("\n".join([*(v for v, _ in rows), *(t for _, t in rows), *faces]) + "\n")


barrel_vault()
ply("fire_in_a_vault_ribs.ply", *joined(*(rib(z) for z in (-5.2, -3.2, -1.2, 0.8, 2.8))))
hdr("fire_in_a_vault_stones.hdr", stones())
bowl = np.array([[0.02, 0.80], [0.14, 0.82], [0.26, 0.88], [0.34, 0.97], [0.37, 1.04], [0.385, 1.04], [0.385, 1.06], [0.36, 1.06], [0.33, 1.0], [0.25, 0.93], [0.13, 0.9], [0.01, 0.89]])
ply("fire_in_a_vault_bowl.ply", *turned(bowl, 48))
random = np.random.default_rng(3)


def coal(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A lump with flat faces."""
    corners = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]) * random.uniform(0.035, 0.07, (6, 1))
    sides = [[a, b, c] for a in (0, 1) for b in (2, 3) for c in (4, 5)]
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    return corners @ turn.T + at, np.array([[a, b, c] if (a + b + c) % 2 == 0 else [a, c, b] for a, b, c in sides])


places = random.uniform(-1, 1, (70, 2)) * 0.24
ply("fire_in_a_vault_coals.ply", *joined(*(coal(np.array([x, 1.02 - 1.2 * (x * x + z * z) + 0.04 * random.uniform(), z])) for x, z in places if np.hypot(x, z) < 0.27)))
