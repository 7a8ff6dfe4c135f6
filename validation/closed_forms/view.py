"""What a perspective camera sees, by quadrature over each pixel."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from validation.closed_forms.case import SIZE, camera


@dataclass(frozen=True)
class View:
    """A camera; fov in degrees."""

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    fov: float
    up: tuple[float, float, float] = (0, 1, 0)
    nodes: int = 8
    """Of the quadrature, along a side of a pixel."""

    def sensor(self, near: float = 1e-4) -> dict:
        """As a scene has it."""
        return camera(self.eye, self.target, self.fov, up=self.up, near_clip=near)

    def directions(self) -> np.ndarray:
        """Unit directions, (rows, columns, nodes, nodes, 3)."""
        centres, nodes = np.arange(SIZE) + 0.5, np.polynomial.legendre.leggauss(self.nodes)[0] / 2
        y, x, v, u = np.meshgrid(centres, centres, nodes, nodes, indexing="ij")
        forward = unit(np.subtract(self.target, self.eye))
        left = unit(np.cross(self.up, forward))
        slope = np.tan(np.radians(self.fov) / 2)
        across, upwards = slope * (1 - 2 * (x + u) / SIZE), slope * (1 - 2 * (y + v) / SIZE)
        return unit(forward + across[..., None] * left + upwards[..., None] * np.cross(forward, left))

    def image(self, radiance: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
        """The means over pixels of the radiance, told by points of the plane y = 0 and their distances from the camera."""
        direction = self.directions()
        distance = -self.eye[1] / direction[..., 1]
        seen = radiance(np.asarray(self.eye) + distance[..., None] * direction, distance)
        return pixel_means(seen)


def pixel_means(values: np.ndarray) -> np.ndarray:
    """From the nodes within pixels to an image."""
    weights = np.polynomial.legendre.leggauss(values.shape[2])[1]
    return (values * (weights[:, None] * weights / 4)).sum(axis=(2, 3))[..., None]


def unit(v: np.ndarray) -> np.ndarray:
    """The vectors at length 1."""
    v = np.asarray(v, dtype=float)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)
