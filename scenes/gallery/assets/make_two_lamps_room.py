"""Writes the vase of two_lamps_room.json beside itself: python3 make_two_lamps_room.py (needs numpy). Few triangles: each is an element
of a first pass."""

from pathlib import Path

from mesh import Mesh

OUTSIDE = [(0.0, 0.0), (0.2, 0.0), (0.27, 0.14), (0.27, 0.26), (0.22, 0.42), (0.13, 0.58), (0.13, 0.64), (0.17, 0.73)]
INSIDE = [(0.15, 0.73), (0.11, 0.63), (0.11, 0.5), (0.0, 0.45)]

if __name__ == "__main__":
    Mesh().lathe(OUTSIDE + INSIDE, sides=16).write(Path(__file__).parent / "two_lamps_room_vase.ply")
