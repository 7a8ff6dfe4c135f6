"""The generated matrix: medium x boundary x camera x emitter x its place x phase function, each cell a small scene.

What all cells share: a floor, a container of medium above it with a ball in it (or, for `room`, opaque walls around a
medium that fills everything), one emitter."""

from dataclasses import astuple, dataclass
from functools import cache
from itertools import combinations, product
from random import Random
from typing import Any

from tyndall.scene import Scene
from validation.cases import ALL, EYE
from validation.places import CROSSCHECK

SEED = 1
SAMPLE = 24
"""How many of the generated scenes every test run compares."""

MEDIA: dict[str, dict[str, Any] | None] = {
    "none": None,
    "grey": {"sigma_t": 1.5, "albedo": 0.8},
    "chromatic": {"sigma_t": (0.2, 0.5, 1.0), "albedo": (0.95, 0.9, 0.7), "scale": 3.0},
    "dense": {"sigma_t": 17.0, "albedo": 0.98},
    "white": {"sigma_t": 2.0, "albedo": 1.0},
}
"""Extinctions are per length; the container is 1.2 thick, so the dense one has optical thickness 20."""
ROOM_SCALE = 0.4
"""A medium that fills the room, 3 thick, is so much thinner."""
GLASS = {"int_ior": 1.4, "ext_ior": 1.0}
BOUNDARIES = {
    "null": {"type": "null"},
    "dielectric": {"type": "dielectric", **GLASS},
    "rough": {"type": "roughdielectric", "distribution": "ggx", "alpha": 0.5, **GLASS},
    "matched": {"type": "dielectric", "int_ior": 1.0, "ext_ior": 1.0},
    "pane": {"type": "thindielectric", "int_ior": 1.5, "ext_ior": 1.0},
    "room": None,
}
SMOOTH = ("dielectric", "matched", "pane")
CAMERAS = ("inside", "outside")
PLACED = ("point", "spot", "projector")
POINTLIKE = (*PLACED, "directional")
DISTANT = ("directional", "constant", "envmap")
EMITTERS = ("area", "point", "spot", "directional", "constant", "envmap", "projector", "textured")
PLACES = ("inside", "outside")
TABLE = "0.8, 0.5, 0.3, 0.2, 0.25, 0.4, 1.1, 3.0"
PHASES = {
    "isotropic": {"type": "isotropic"},
    "forward": {"type": "hg", "g": 0.8},
    "backward": {"type": "hg", "g": -0.5},
    "rayleigh": {"type": "rayleigh"},
    "blend": {"type": "blendphase", "weight": 0.4, "first": {"type": "hg", "g": 0.6}, "second": {"type": "rayleigh"}},
    "table": {"type": "tabphase", "values": TABLE},
}


@dataclass(frozen=True)
class Cell:
    """One scene of the matrix; `place` is the emitter's, all of them keys of the tables above."""

    medium: str
    boundary: str
    camera: str
    emitter: str
    place: str
    phase: str

    @property
    def name(self) -> str:
        """Its values in a row: a file name."""
        light = f"{self.emitter}_{self.place}"
        return "-".join(["cell", self.medium, self.boundary, f"camera_{self.camera}", light, self.phase])

    @property
    def point_in_medium(self) -> bool:
        """A point of light in a medium. A vertex at distance r from it counts 1 / r^2: a path tracer, Mitsuba's too,
        has no finite variance, unless no vertex comes near. So these cells have single scattering only, and the light
        out of view."""
        return self.emitter in PLACED and self.place == "inside" and self.medium != "none"

    def possible(self) -> bool:
        """False where nothing can be compared; each line says why."""
        room, infinite, vacuum = self.boundary == "room", self.emitter in DISTANT, self.medium == "none"
        return not any(
            (
                infinite and self.place == "inside",  # what is infinitely far is in no container
                room and self.place == "outside",  # opaque walls: no light would get in
                room and self.camera == "outside",  # nor out
                # No next-event estimate passes a smooth interface, and no walk hits a point or a single direction:
                # Mitsuba's path tracers lack that light altogether (its particle tracer has no media).
                self.boundary in SMOOTH and self.emitter in POINTLIKE,
                self.point_in_medium and self.camera == "outside",  # see `point_in_medium`: the light is in view
                # A point of light beyond a rough boundary is seen by rare, bright paths only: what Mitsuba's batches say
                # of their own error is too little to judge by.
                self.boundary == "rough" and self.emitter in PLACED and self.place != self.camera,
                # What little leaves twenty mean free paths around a lamp: rare paths again, or (single scattering) none.
                self.medium == "dense" and self.point_in_medium,
                self.medium == "dense" and self.boundary in SMOOTH and self.place == "inside" and self.camera == "outside",
                vacuum and self.phase != "isotropic",  # no medium, no phase function
                vacuum and self.boundary == "null",  # the same as no boundary: an empty scene's affair
            )
        )

    def methods(self) -> tuple[str, ...]:
        """Who can render it; see `cases.EYE` for why light tracing cannot always. Through rough glass its errors are
        rare fireflies (walks whose last interface sends them almost straight to the lens), too rare for its batches. What
        leaves a dense or white medium around a lamp reaches the camera by rare, bright paths of Mitsuba's: most of its
        pixels are too dark and claim to be exact. `pt` errs alike; `lt` and `bdpt`, which have less noise, would be refused
        (against 2000 samples of `pt` they are not)."""
        if self.medium in ("dense", "white") and self.boundary not in SMOOTH and (self.place, self.camera) == ("inside", "outside"):
            return ("pt",)
        in_medium = self.camera == "inside" and self.medium != "none"
        return ALL if not in_medium and self.boundary in ("null", "room") else EYE

    def effort(self) -> float:
        """Samples relative to the common number: more where Mitsuba finds the light by chance only, most where it has to
        come out of a smooth container first."""
        by_chance = self.boundary in SMOOTH and self.place == "inside" or self.boundary == "rough"
        enclosed = self.boundary in SMOOTH and self.place == "inside" and self.camera == "outside"
        return (6 if enclosed else 3 if by_chance else 1.5) * (0.5 if self.medium in ("dense", "white") and not self.point_in_medium else 1)

    def scene(self) -> Scene:
        """The dictionary of `mitsuba.load_dict`."""
        tree = {"type": "scene", "integrator": self.integrator(), **self.media(), "sensor": self.sensor()}
        return Scene({**tree, **self.stage(), **self.light()}, self.name, base=CROSSCHECK)

    def integrator(self) -> dict:
        """Paths of unlimited depth where absorption ends them soon."""
        depth = 2 if self.point_in_medium else 24 if self.medium in ("dense", "white") else -1
        kind = "volpathmis" if self.medium == "chromatic" else "volpath"
        return {"type": kind, "max_depth": depth, "rr_depth": 16 if depth < 0 else 100}

    def media(self) -> dict:
        """The medium under its id."""
        chosen = MEDIA[self.medium]
        if chosen is None:
            return {}
        values: dict[str, Any] = {key: rgb(*value) if isinstance(value, tuple) else value for key, value in chosen.items()}
        scale = values.get("scale", 1.0) * (ROOM_SCALE if self.boundary == "room" else 1.0)
        return {"stuff": {"type": "homogeneous", **values, "scale": scale, "phase": PHASES[self.phase]}}

    def filled(self, side: str) -> dict:
        """A reference to the medium as the `side` of something; nothing where there is none."""
        return {} if self.medium == "none" else {side: {"type": "ref", "id": "stuff"}}

    def sensor(self) -> dict:
        """A camera in the container, or before it."""
        inside = self.camera == "inside"
        origin, target = ([0.1, 0.95, 0.45], [0.1, 0.75, -0.3]) if inside else ([0, 1.5, 3.8], [0, 0.75, 0])
        return {
            "type": "perspective",
            "fov": 75 if inside else 40,
            "to_world": [{"type": "lookat", "origin": origin, "target": target, "up": [0, 1, 0]}],
            "film": {"type": "hdrfilm", "width": 16, "height": 12, "pixel_format": "rgb", "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": 64},
            **(self.filled("medium") if inside else {}),
        }

    def stage(self) -> dict:
        """The floor, the ball, and what holds the medium."""
        ball = {"type": "sphere", "center": [0.3, 0.65, -0.25], "radius": 0.22, "bsdf": diffuse(0.7, 0.4, 0.2)}
        return {"ball": ball, **(self.walls() if self.boundary == "room" else self.container())}

    def container(self) -> dict:
        """A cube of medium over a floor."""
        to_world = [{"type": "scale", "value": [0.8, 0.6, 0.6]}, {"type": "translate", "value": [0, 0.9, 0]}]
        cube = {"type": "cube", "to_world": to_world, "bsdf": BOUNDARIES[self.boundary], **self.filled("interior")}
        return {"floor": rectangle(2.5, [-90, 0], [0, 0.1, 0], diffuse(0.5, 0.5, 0.6)), "container": cube}

    def walls(self) -> dict:
        """A closed room."""
        to_world = [{"type": "scale", "value": [1.5, 1.1, 1.5]}, {"type": "translate", "value": [0, 1.2, 0]}]
        return {"walls": {"type": "cube", "flip_normals": True, "to_world": to_world, "bsdf": diffuse(0.5, 0.5, 0.6)}}

    def light(self) -> dict:
        """The emitter; where it is inside, it shines on the ball from behind and above the inner camera,
        and touches no boundary."""
        inside = self.place == "inside"
        within = [-0.35, 1.2, 0.35] if self.camera == "inside" else [-0.35, 1.15, 0.1]
        position = within if inside else [-1.1, 2.3, 1.0]
        aim = [{"type": "lookat", "origin": position, "target": [0.1, 0.6, -0.25], "up": [0, 1, 0.1]}]
        power = 0.25 if inside else 1.0
        return {"light": self.emitters(position, aim, power)}

    def emitters(self, position: list, aim: list, power: float) -> dict:
        """The one of this cell; `power` is relative."""
        picture = {"type": "bitmap", "filename": "assets/slide.hdr", "raw": True}
        match self.emitter:
            case "area" | "textured":
                size = 0.9 if self.place == "outside" else 0.12 if self.camera == "inside" else 0.3
                radiance = picture if self.emitter == "textured" else rgb(3, 2.5, 2)
                to_world = [{"type": "scale", "value": size}, *aim]
                lamp = {"type": "rectangle", "to_world": to_world, "bsdf": diffuse(0, 0, 0)}
                return {**lamp, "emitter": {"type": "area", "radiance": radiance}}
            case "point":
                return {"type": "point", "position": position, "intensity": rgb(6 * power, 5 * power, 4 * power)}
            case "spot":
                intensity = rgb(20 * power, 15 * power, 12 * power)
                return {"type": "spot", "to_world": aim, "intensity": intensity, "cutoff_angle": 35}
            case "projector":
                return {"type": "projector", "to_world": aim, "irradiance": picture, "scale": 10 * power, "fov": 50}
            case "directional":
                return {"type": "directional", "direction": [0.4, -1, -0.5], "irradiance": rgb(3, 2.5, 2)}
            case "constant":
                return {"type": "constant", "radiance": rgb(0.5, 0.7, 1)}
            case _:
                turn = [{"type": "rotate", "axis": [0, 1, 0], "angle": 70}]
                return {"type": "envmap", "filename": "assets/dusk.exr", "to_world": turn}


def rgb(*value: float) -> dict:
    """A colour."""
    return {"type": "rgb", "value": list(value)}


def diffuse(*reflectance: float) -> dict:
    """A matt surface."""
    return {"type": "diffuse", "reflectance": rgb(*reflectance)}


def rectangle(size: float, turns: list, place: list, bsdf: dict) -> dict:
    """A square of half width `size`, turned about x and y [degrees]."""
    steps = [{"type": "scale", "value": size}]
    steps += [{"type": "rotate", "axis": axis, "angle": angle} for axis, angle in zip(([1, 0, 0], [0, 1, 0]), turns)]
    return {"type": "rectangle", "to_world": [*steps, {"type": "translate", "value": place}], "bsdf": bsdf}


@cache
def cells() -> tuple[Cell, ...]:
    """All that are possible."""
    whole = product(MEDIA, BOUNDARIES, CAMERAS, EMITTERS, PLACES, PHASES)
    return tuple(cell for values in whole if (cell := Cell(*values)).possible())


def sample(count: int = SAMPLE, seed: int = SEED) -> list[Cell]:
    """Some cells, always the same for a seed. Each next one is the cell of a shuffled list that adds the most pairs of
    values not seen before."""
    left, seen, chosen = list(cells()), set[Any](), list[Cell]()
    Random(seed).shuffle(left)
    while left and len(chosen) < count:
        best = max(left, key=lambda cell: len(pairs(cell) - seen))
        left.remove(best)
        seen |= pairs(best)
        chosen.append(best)
    return chosen


def pairs(cell: Cell) -> set:
    """All pairs of its values."""
    return set(combinations(enumerate(astuple(cell)), 2))
