"""Scenes that nobody made: a number decides on the stage, media, lamps, objects and the camera. What is drawn stands in a cube of
2 x 2 x 2 m over the origin; things are balls to each other, so that none touches another or the boundary of the fog."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from random import Random
from typing import Any

import numpy as np

from validation.closed_forms.case import film

Point = tuple[float, float, float]
Tree = dict[str, Any]
CENTRE: Point = (0, 1, 0)
WIDTH, HEIGHT = 32, 24
SIDES: list[Point] = [(0, -1, 0), (0, 1, 0), (-1, 0, 0), (1, 0, 0), (0, 0, -1), (0, 0, 1)]
"""From the middle of a room to its floor, ceiling and walls."""
STAGES = ("room", "window", "open")
TRIES = 200
"""So many places are tried for a thing before it is left out."""


@dataclass(frozen=True)
class Drawn:
    """A scene, and in a few words what it is."""

    tree: Tree
    words: str


def drawn(seed: int, attempt: int = 0) -> Drawn:
    """The scene of a seed, always the same; another one for each attempt."""
    return Draw(Random(f"{seed}/{attempt}")).scene()


@dataclass(frozen=True)
class Fog:
    """A box of medium: all the room, or a part of what there is."""

    centre: Point
    half: float
    is_all: bool

    def holds(self, place: Point, radius: float) -> bool | None:
        """Whether a ball is in it; None if its boundary crosses the ball."""
        off = max(abs(a - b) for a, b in zip(place, self.centre))
        return True if off < self.half - radius else False if off > self.half + radius else None


@dataclass
class Draw:
    """A scene while it is drawn."""

    random: Random
    tree: Tree = field(default_factory=dict)
    words: list[str] = field(default_factory=list)
    fog: Fog | None = None
    taken: list[tuple[Point, float]] = field(default_factory=list)
    """Balls that hold what is there already."""

    def scene(self) -> Drawn:
        """All of it."""
        stage = self.random.choice(STAGES)
        self.words.append(stage)
        self.draw_fog(stage)
        sensor = self.sensor(stage)
        lights = self.lights(stage)
        self.objects()
        walls = self.walls(stage)
        return Drawn({"type": "scene", **self.tree, "sensor": sensor, **walls, **lights}, ", ".join(self.words))

    def chance(self, probability: float) -> bool:
        return self.random.random() < probability

    def power(self, low: float, high: float) -> float:
        """A number of any order of magnitude in between."""
        return math.exp(self.random.uniform(math.log(low), math.log(high)))

    def colour(self, low: float, high: float, grey: float = 0.5) -> Tree:
        """Between these in every channel, all alike with the probability `grey`."""
        first, *others = (self.random.uniform(low, high) for _ in range(3))
        return {"type": "rgb", "value": [first] * 3 if self.chance(grey) else [first, *others]}

    def place(self, radius: float) -> Point | None:
        """Where a ball fits in; taken from then on."""
        for _ in range(TRIES):
            x, y, z = (self.random.uniform(radius - 0.98, 0.98 - radius) for _ in range(3))
            place = (x, y + 1, z)
            apart = all(math.dist(place, other) > radius + size for other, size in self.taken)
            if apart and (self.fog is None or self.fog.holds(place, radius) is not None):
                self.taken.append((place, radius))
                return place
        return None

    def around(self, place: Point, side: str) -> Tree:
        """What is around a thing there, as the `side` of a shape or the `medium` of a point; nothing in vacuum."""
        return {side: ref("fog")} if self.fog and self.fog.holds(place, 0) else {}

    def draw_fog(self, stage: str) -> None:
        """None, a box of it, or all the room; perhaps it holds a ball of another one."""
        kind = self.random.choice(("none", "box", "box") if stage == "open" else ("none", "box", "all", "all"))
        if kind == "none":
            return
        half = 1.0 if kind == "all" else self.random.uniform(0.35, 0.9)
        self.fog = Fog((0, 1, 0), half, kind == "all")
        self.tree["fog"] = self.medium(self.fog.centre, half, f"{kind} of")
        if kind == "box":
            self.tree["box"] = {"type": "cube", "to_world": scaled(half, self.fog.centre), "bsdf": {"type": "null"}, "interior": ref("fog")}
        radius = half * self.random.uniform(0.2, 0.5)
        if self.chance(0.3) and (place := self.place(radius)):
            inner = {"interior": self.medium(place, radius, "a ball of"), **self.around(place, "exterior")}
            self.tree["nested"] = {"type": "sphere", "center": list(place), "radius": radius, "bsdf": {"type": "null"}, **inner}

    def medium(self, centre: Point, half: float, name: str) -> Tree:
        """Any medium in a box."""
        depth, grey = self.power(0.1, 20), self.chance(0.6)
        g = 0.0 if self.chance(0.3) else self.random.uniform(-0.3, 0.95)
        least = 1 - self.power(0.001, 0.7)
        albedo = least if grey else {"type": "rgb", "value": [self.random.uniform(least, 0.999) for _ in range(3)]}
        kind = self.random.choice(("homogeneous",) * 4 + ("grid", "grid", "exponential", "cosine", "noise"))
        self.words.append(f"{name} {'grey' if grey else 'chromatic'} {kind} {depth:.2g} mfp g {g:.2g} albedo {least:.3g}")
        common = {"albedo": albedo, "scale": depth / (2 * half), "phase": {"type": "hg", "g": g}}
        if kind == "homogeneous":
            return {"type": kind, "sigma_t": 1.0 if grey else self.colour(0.3, 1, grey=0), **common}
        return {"type": "heterogeneous", "sigma_t": self.volume(kind, centre, half), **common}

    def volume(self, kind: str, centre: Point, half: float) -> Tree:
        """Extinction that varies over a box, about 1."""
        match kind:
            case "grid":
                corner = [at - half for at in centre]
                steps = [{"type": "scale", "value": 2 * half}, {"type": "translate", "value": corner}]
                return {"type": "gridvolume", "data": self.blobs(24), "to_world": steps}
            case "exponential":
                up = [self.random.gauss(0, 0.3), 1, self.random.gauss(0, 0.3)]
                return {"type": kind, "up": up, "height": centre[1], "scale_height": half * self.power(0.3, 3)}
            case "cosine":
                vector = [self.random.gauss(0, 3 / half) for _ in range(3)]
                wave = {"type": "wave", "amplitude": 0.9, "vector": vector, "phase": self.random.uniform(0, 6.28)}
                return {"type": kind, "constant": 1.0, "wave": wave}
            case _:
                return {"type": kind, "style": "fractal", "frequency": self.power(0.5, 3) / half, "octaves": 3,
                        "bias": self.random.uniform(-0.2, 0.6), "amplitude": 2, "seed": self.random.randrange(1000)}  # fmt: skip

    def blobs(self, voxels: int) -> np.ndarray:
        """Some soft balls, (z, y, x), at most 2.5."""
        at = (np.arange(voxels) + 0.5) / voxels
        z, y, x = np.meshgrid(at, at, at, indexing="ij")
        total = np.zeros_like(x)
        for _ in range(self.random.randint(1, 8)):
            a, b, c = (self.random.uniform(0.15, 0.85) for _ in range(3))
            total += np.exp(-((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / self.random.uniform(0.05, 0.25) ** 2)
        return np.minimum(2 * np.maximum(total - 0.1, 0), 2.5)

    def sensor(self, stage: str) -> Tree:
        """A camera that looks to the middle, roughly; outside of the fog or in it."""
        near = stage != "open" or self.chance(0.3)
        found = self.place(0.1) if near else None
        turn = self.random.uniform(0, 2 * math.pi)
        far = self.random.uniform(3, 5)
        origin = found or (far * math.cos(turn), self.random.uniform(0.3, 2.5), far * math.sin(turn))
        within = self.around(origin, "medium")
        self.words.append("camera in fog" if within else "camera outside")
        target = [at + self.random.gauss(0, 0.2) for at in CENTRE]
        return {"type": "perspective", "fov": self.random.uniform(50, 90) if near else self.random.uniform(25, 45),
                "to_world": [aimed(origin, target)], "film": film(WIDTH, HEIGHT), **within}  # fmt: skip

    def lights(self, stage: str) -> Tree:
        """Sky, sun and lamps, one at least that light can come in from."""
        out = {} if stage == "room" else self.distant()
        beyond = stage == "window" and (not out or self.chance(0.3))
        count = round(self.power(1, 20)) if stage == "room" or self.chance(0.4) or not (out or beyond) else 0
        lamps = {f"lamp{n}": lamp for n in range(count) if (lamp := self.lamp())}
        kinds = sorted({str(lamp["type"]) for lamp in lamps.values()})
        self.words += [f"{len(lamps)} lamps ({' '.join(kinds)})"] if lamps else []
        if beyond:
            self.words.append("lamp beyond")
            at = (self.random.uniform(-0.5, 0.5), self.random.uniform(2.5, 5), self.random.uniform(-0.5, 0.5))
            lamps["beyond"] = self.kind_of_lamp(at, self.power(0.02, 0.4), [0, 2, 0], 100)
        return {**out, **lamps}

    def distant(self) -> Tree:
        """A sky, a sun, both or neither."""
        out: Tree = {}
        if self.chance(0.6):
            even = self.chance(0.5)
            out["sky"] = {"type": "constant", "radiance": self.colour(0.2, 1)} if even else {"type": "envmap", "data": self.surroundings()}
            self.words.append("sky" if even else "envmap")
        if self.chance(0.4):
            down = [self.random.gauss(0, 0.6), -1, self.random.gauss(0, 0.6)]
            out["sun"] = {"type": "directional", "direction": down, "irradiance": self.colour(1, 8)}
            self.words.append("sun")
        return out

    def surroundings(self) -> np.ndarray:
        """A picture of a sky that brightens upwards, with some bright spots."""
        y, x = np.mgrid[0:16, 0:32]
        picture = np.outer(1 - y[:, 0] / 20, np.ones(32))[..., None] * [0.3, 0.4, 0.6]
        for _ in range(self.random.randint(1, 4)):
            row, column, size = self.random.uniform(1, 8), self.random.uniform(2, 30), self.random.uniform(0.5, 2)
            spot = np.exp(-((x - column) ** 2 + (y - row) ** 2) / size**2)
            picture = picture + self.power(1, 1000) * spot[..., None] * [1, 0.9, 0.7]
        return picture

    def lamp(self) -> Tree | None:
        """One of any kind and size, where there is room for it."""
        size = self.power(0.01, 0.2)
        target = [self.random.uniform(-0.7, 0.7), self.random.uniform(0, 1.4), self.random.uniform(-0.7, 0.7)]
        place = self.place(1.5 * size)
        return place and self.kind_of_lamp(place, size, target, self.power(3, 30))

    def kind_of_lamp(self, at: Point, size: float, target: list[float], watts: float) -> Tree:
        """A lamp of that power."""
        light = lambda radiance: {"type": "area", "radiance": {"type": "rgb", "value": [radiance, 0.9 * radiance, 0.7 * radiance]}}
        within = self.around(at, "medium")
        match self.random.choice(("sphere", "rectangle", "point", "spot")):
            case "sphere":
                ball = {"type": "sphere", "center": list(at), "radius": size, **self.around(at, "exterior")}
                return {**ball, "emitter": light(watts / (2 * math.pi * size) ** 2)}
            case "rectangle":
                steps = [{"type": "scale", "value": size}, aimed(at, target)]
                sides = {**self.around(at, "exterior"), **self.around(at, "interior")}
                return {"type": "rectangle", "to_world": steps, "emitter": light(watts / (4 * math.pi * size**2)), **sides}
            case "point":
                return {"type": "point", "position": list(at), "intensity": watts / (4 * math.pi), **within}
            case _:
                angle = self.random.uniform(5, 60)
                intensity = watts / (2 * math.pi * (1 - math.cos(math.radians(angle))))
                return {"type": "spot", "to_world": [aimed(at, target)], "cutoff_angle": angle, "intensity": intensity, **within}

    def objects(self) -> None:
        """A few balls and cubes."""
        names = []
        for number in range(self.random.randint(0, 6)):
            radius = self.random.uniform(0.08, 0.35)
            if place := self.place(radius):
                bsdf = self.random.choice(list(SURFACES))
                names.append(bsdf)
                self.tree[f"object{number}"] = self.object(place, radius, bsdf)
        self.words += [f"{' '.join(sorted(names))}"] if names else []

    def object(self, place: Point, radius: float, bsdf: str) -> Tree:
        """One; glass may be filled."""
        half = radius / math.sqrt(3)
        shape = {"type": "sphere", "center": list(place), "radius": radius}
        if self.chance(0.5):
            shape = {"type": "cube", "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": self.random.uniform(0, 90)}, *scaled(half, place)]}
        filled = "dielectric" in bsdf and self.chance(0.4)
        inner = {"interior": self.medium(place, half, "in glass")} if filled else {}
        return {**shape, "bsdf": SURFACES[bsdf](self), **inner, **self.around(place, "exterior")}

    def walls(self, stage: str) -> Tree:
        """Those of a room, whose ceiling may have a window, or the ground."""
        paint = {"paint": {"type": "diffuse", "reflectance": self.colour(0.1, 0.9)}}
        if stage == "open":
            ground = [{"type": "scale", "value": 20}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90}]
            return {**paint, "ground": {"type": "rectangle", "to_world": ground, "bsdf": ref("paint")}}
        hole = self.power(0.03, 0.8) if stage == "window" else 0.0
        self.words += [f"hole {2 * hole:.2g} m"] if hole else []
        walls = {f"wall{n}": wall(side, (1, 1), (0, 0)) for n, side in enumerate(SIDES) if not (hole and side == SIDES[1])}
        rim = (1 - hole) / 2
        frame = {(rim, 1): (1 - rim, 0), (-rim, 1): (rim - 1, 0), (hole, rim): (0, 1 - rim), (hole, -rim): (0, rim - 1)} if hole else {}
        walls |= {f"frame{n}": wall(SIDES[1], (abs(x), abs(y)), off) for n, ((x, y), off) in enumerate(frame.items())}
        if hole and self.fog and self.fog.is_all:
            walls["hole"] = {**wall(SIDES[1], (hole, hole), (0, 0)), "bsdf": {"type": "null"}, "exterior": ref("fog")}
        return {**paint, **walls}


SURFACES: dict[str, Callable[[Draw], Tree]] = {
    "diffuse": lambda draw: {"type": "diffuse", "reflectance": draw.colour(0.1, 0.9)},
    "conductor": lambda draw: {"type": "conductor", "material": draw.random.choice(("Au", "Cu", "none"))},
    "roughconductor": lambda draw: {"type": "roughconductor", "material": "Cu", "distribution": "ggx", "alpha": draw.power(0.03, 0.5)},
    "dielectric": lambda draw: {"type": "dielectric", "int_ior": draw.random.uniform(1.2, 1.8), "ext_ior": 1.0},
    "roughdielectric": lambda draw: {"type": "roughdielectric", "int_ior": 1.5, "ext_ior": 1.0, "distribution": "ggx", "alpha": draw.power(0.05, 0.5)},
    "plastic": lambda draw: {"type": "plastic", "diffuse_reflectance": draw.colour(0.1, 0.9)},
}


def ref(name: str) -> Tree:
    """What the scene calls so."""
    return {"type": "ref", "id": name}


def scaled(half: float, centre: Point) -> list[Tree]:
    """To a box or square of that half width."""
    return [{"type": "scale", "value": half}, {"type": "translate", "value": list(centre)}]


def aimed(origin: Point, target: list[float]) -> Tree:
    """Turns +z to the target; up is any direction across, as `target` may be straight below."""
    x, y, z = (abs(a - b) for a, b in zip(origin, target))
    return {"type": "lookat", "origin": list(origin), "target": target, "up": [0, 0, 1] if y > 3 * max(x, z) else [0, 1, 0]}


def wall(side: Point, half: tuple[float, float], off: tuple[float, float]) -> Tree:
    """A part of the wall on that side of the room, facing inwards."""
    steps = [{"type": "scale", "value": [*half, 1]}, {"type": "translate", "value": [*off, 0]}]
    origin = (side[0], side[1] + 1, side[2])
    return {"type": "rectangle", "to_world": [*steps, aimed(origin, [0, 1, 0])], "bsdf": ref("paint")}
