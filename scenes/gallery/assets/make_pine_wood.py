"""Meshes of ../pine_wood.json, and where its trees and ferns stand, which it writes into that file: python3 make_pine_wood.py
(needs numpy)."""

import json
from pathlib import Path

import numpy as np

from files import noise
from mesh import Mesh

HERE = Path(__file__).parent
SCENE = HERE.parent / "pine_wood.json"
RANDOM = np.random.default_rng(12)
PATH = 1.3
"""Half the width of the path along z = 0 to -60 that stays free (m)."""


def ground(x, z):
    """Height of the soil (m): uneven, trodden flat along the path."""
    at = np.stack([x, z], -1)
    beside = np.clip((np.abs(x - winding(z)) - 0.6) / 2.5, 0, 1)
    return 0.9 * noise(at / 14, 3, 2) + beside * (0.22 * noise(at / 2.3, 4, 4) + 0.12)


def winding(z):
    """Where the middle of the path is, by z (m)."""
    return 1.6 * np.sin(z / 13)


def soil():
    """A grid, finer in front."""
    zs = np.concatenate([np.linspace(8, -16, 73)[:-1], np.linspace(-16, -75, 40)])
    z, x = np.meshgrid(zs, np.concatenate([np.linspace(-45, -8, 20)[:-1], np.linspace(-8, 8, 49), np.linspace(8, 45, 20)[1:]]), indexing="ij")
    return Mesh().grid(np.stack([x, ground(x, z), z], -1)[::-1])


def pine(height, first, reach):
    """Wood and needles of a pine: dead stubs below, whorls of drooping branches above the height `first`."""
    wood, needles = Mesh(), Mesh()
    ys = np.linspace(-0.6, height, 9)
    sway = np.cumsum(RANDOM.normal(0, 0.05, (9, 2)), 0)
    stem = np.stack([sway[:, 0], ys, sway[:, 1]], -1)
    wood.tube(stem, 0.26 * (1 - ys / height * 0.93), 9)
    wood.tube([stem[0], (stem[0, 0], 0.5, stem[0, 2])], [0.4, 0.24], 9)
    for y in np.arange(0.28 * height, first, 0.55):
        branch(wood, None, along(stem, y), RANDOM.uniform(0.3, 1.1), RANDOM.uniform(0, 2 * np.pi), 0)
    for y in np.arange(first, height - 0.3, 0.62):
        share = (height - y) / (height - first)
        for turn in RANDOM.uniform(0, 2 * np.pi) + np.arange(5) * 2 * np.pi / 5:
            branch(wood, needles, along(stem, y), reach * (0.18 + share**0.8) * RANDOM.uniform(0.75, 1.1), turn + RANDOM.normal(0, 0.2), share)
    return wood, needles


def along(stem, y):
    """The point of a stem at a height."""
    return np.array([np.interp(y, stem[:, 1], stem[:, axis]) for axis in range(3)])


def branch(wood, needles, start, length, turn, droop):
    """One branch, drooping as old ones do, and the tufts along its outer part."""
    out = np.array([np.cos(turn), 0, np.sin(turn)])
    t = np.linspace(0, 1, 4)
    path = start + length * t[:, None] * out + np.array([0, 1, 0]) * (length * (0.12 * t - 0.42 * droop * t**1.6))[:, None]
    wood.tube(path, 0.035 * np.sqrt(length / 2) * (1 - 0.8 * t), 3)
    if needles is None:
        return
    side = np.cross(out, (0, 1, 0))
    for place in np.linspace(0.3, 1, 2 + round(3 * length)):
        middle = start + (path[-1] - start) * place
        for _ in range(7):
            way = out * RANDOM.normal(0.25, 0.2) + side * RANDOM.normal(0, 0.42) + np.array([0, RANDOM.normal(-0.04, 0.09), 0])
            across = np.cross(way, RANDOM.normal(0, 1, 3))
            across *= 0.11 / np.linalg.norm(across)
            needles.face(middle - across, middle + across, middle + way * (0.45 + 0.4 * length / 3))


def fern():
    """Fronds that arch out of one root, each with leaflets on both sides."""
    mesh = Mesh()
    for turn in np.arange(11) * 2 * np.pi / 11 + RANDOM.normal(0, 0.15, 11):
        out, up, length = np.array([np.cos(turn), 0, np.sin(turn)]), np.array([0, 1, 0]), RANDOM.uniform(0.5, 0.85)
        side = np.cross(out, up)
        for t in np.linspace(0.12, 0.98, 15):
            middle = length * (t * out + (1.0 * t - 0.95 * t**2.2) * up)
            leaf = 0.19 * length * np.sin(np.pi * min(1, t * 0.9 + 0.16)) + 0.01
            for way in (side, -side):
                mesh.face(middle - 0.022 * out, middle + 0.022 * out, middle + leaf * way + 0.3 * leaf * out - 0.25 * leaf * up)
    return mesh


def placed(group, x, z, size):
    """An instance of a group: turned by chance, so large, standing on the soil."""
    steps = [
        {"type": "rotate", "axis": [0, 1, 0], "angle": round(RANDOM.uniform(0, 360))},
        {"type": "scale", "value": round(float(size), 2)},
        {"type": "translate", "value": [round(float(v), 2) for v in (x, ground(x, z), z)]},
    ]
    return {"type": "instance", "of": {"type": "ref", "id": group}, "to_world": steps}


def scattered(count, apart, low, high, free):
    """Places (x, z) between two corners, so far apart from each other and from the path."""
    places = []
    for at in RANDOM.uniform(low, high, (60 * count, 2)):
        if len(places) < count and abs(at[0] - winding(at[1])) > free and all(np.hypot(*(at - other)) > apart for other in places):
            places.append(at)
    return places


def stand():
    """The trees and ferns of the scene, by name."""
    trees = scattered(240, 2.0, (-34, -66), (34, 8), PATH)
    trees = [at for at in trees if np.hypot(at[0], at[1]) > 3.0]
    ferns = scattered(150, 0.6, (-11, -24), (11, 0), 0.9)
    named = {f"tree_{i}": placed(("old", "slim", "young")[i % 3], *at, RANDOM.uniform(0.82, 1.15)) for i, at in enumerate(trees)}
    return named | {f"fern_{i}": placed("fern", *at, RANDOM.uniform(0.6, 1.2)) for i, at in enumerate(ferns)}


def rewrite():
    """Puts them into the scene, in place of those that it had."""
    scene = {name: value for name, value in json.loads(SCENE.read_text()).items() if not name.startswith(("tree_", "fern_"))}
    lines = [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in {**scene, **stand()}.items()]
    SCENE.write_text("{" + ",\n ".join(lines) + "}\n")


if __name__ == "__main__":
    soil().write(HERE / "pine_wood_soil.ply")
    for name, shape in dict(old=(23, 10.5, 2.9), slim=(21, 12.5, 2.2), young=(12, 3.5, 2.0)).items():
        for part, mesh in zip(("wood", "needles"), pine(*shape)):
            mesh.write(HERE / f"pine_wood_{name}_{part}.ply")
    fern().write(HERE / "pine_wood_fern.ply")
    rewrite()
