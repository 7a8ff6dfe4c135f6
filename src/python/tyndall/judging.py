"""The test of two renderers against each other: Welch's test for each value of their images, of tiles, and of the whole."""

from dataclasses import dataclass

import numpy as np

from tyndall.statistics import Estimate, estimate, exact, sidak_limit, standard_score

ACCEPTED = 0.9975
"""Share of pixel values that must pass, as in Mitsuba's own render tests."""
TILES = 6
"""The image is also compared as so many tiles a side, all of which must pass: what is wrong in one place only."""
IMAGE_ERRORS = 3
"""How many standard errors the image means may be apart."""
NAME_WIDTH, METHOD_WIDTH = 36, 19
"""Of the printed table's first columns [characters]."""


@dataclass(frozen=True)
class Measured:
    """An image as it is compared: its pixels (height, width, 3), the means of its tiles, and that of the whole (3,)."""

    pixels: Estimate
    tiles: Estimate
    whole: Estimate

    @staticmethod
    def of(batches: np.ndarray) -> "Measured":
        """The mean of independent images."""
        return Measured(estimate(batches), estimate(tiled(batches)), estimate(batches.mean(axis=(1, 2))))

    @staticmethod
    def exactly(image: np.ndarray) -> "Measured":
        """An image known without error."""
        return Measured(exact(image), exact(tiled(image[None])[0]), exact(image.mean(axis=(0, 1))))


@dataclass(frozen=True)
class Verdict:
    """What a comparison found."""

    scene: str
    integrator: str
    accepted: float
    """Share of pixel values within the limit for all of them."""
    tile_score: float
    """The worst tile's z, over the limit for all tiles: above 1 is refused."""
    image_score: float
    """Difference of the image means in standard errors, the worst channel, with its sign."""
    difference: float
    """The same, relative to the mean."""
    resolution: float
    """The relative difference that would have been refused."""
    worst: tuple[int, int]
    """The pixel (x, y) that disagrees most."""
    seconds: float
    trials: int = 1
    map: np.ndarray | None = None
    """z of each value."""
    reference: np.ndarray | None = None
    """The mean of Mitsuba's batches."""
    found: np.ndarray | None = None
    """The mean of the candidate's."""
    reference_seconds: float | None = None
    expected: tuple[str, ...] = ()
    """Light that only one of both sides reaches: a disagreement is no fault then."""

    @property
    def passed(self) -> bool:
        return self.accepted >= ACCEPTED and self.tile_score <= 1 and abs(self.image_score) <= IMAGE_ERRORS

    @property
    def word(self) -> str:
        """The verdict in a word."""
        return "agree" if self.passed else "DIFFER" if self.expected else "DISAGREE"

    @property
    def why(self) -> str:
        """Why a difference is no fault, on lines of its own."""
        return "" if self.passed else "".join(f"\n  no fault: {reason}" for reason in self.expected)

    def row(self) -> str:
        where = "" if self.passed else f"  worst pixel {self.worst}"
        again = "" if self.trials == 1 else f"  ({self.trials} trials)"
        return (
            f"{self.scene:{NAME_WIDTH}} {self.integrator:{METHOD_WIDTH}} {100 * self.accepted:8.2f} % {self.tile_score:6.2f} {self.image_score:+8.2f}"
            f" {100 * self.difference:+8.2f} % {100 * self.resolution:7.2f} % {self.seconds:7.1f} s"
            f"  {self.word}{where}{again}{self.why}"
        )


HEADER = (
    f"{'scene':{NAME_WIDTH}} {'method':{METHOD_WIDTH}} {'accepted':>10} {'tiles':>6} {'mean, se':>8} {'mean, rel':>10} {'resolves':>9} {'time':>9}  verdict"
)


def judge(scene: str, method: str, ours: Measured, theirs: Measured, seconds: float) -> Verdict:
    """The test itself."""
    z = standard_score(ours.pixels, theirs.pixels)
    tiles = standard_score(ours.tiles, theirs.tiles)
    score = standard_score(ours.whole, theirs.whole)
    channel = int(np.abs(score).argmax())
    y, x = np.unravel_index(np.abs(z).max(axis=2).argmax(), z.shape[:2])
    return Verdict(
        scene=scene,
        integrator=method,
        accepted=float((np.abs(z) <= sidak_limit(z.size)).mean()),
        tile_score=float(np.abs(tiles).max() / sidak_limit(tiles.size)),
        image_score=float(score[channel]),
        difference=relative_difference(ours.whole, theirs.whole, channel),
        resolution=IMAGE_ERRORS * float(np.hypot(ours.whole.error, theirs.whole.error).max() / theirs.whole.mean.max()),
        worst=(int(x), int(y)),
        seconds=seconds,
        map=z,
        reference=theirs.pixels.mean,
        found=ours.pixels.mean,
    )


def tiled(batches: np.ndarray, tiles: int = TILES) -> np.ndarray:
    """The batches as images of tiles x tiles means (what is left over at the right and below is dropped)."""
    count, height, width, channels = batches.shape
    tall, wide = max(1, height // tiles), max(1, width // tiles)
    rows, columns = height // tall, width // wide
    cut = batches[:, : rows * tall, : columns * wide]
    return cut.reshape(count, rows, tall, columns, wide, channels).mean(axis=(2, 4))


def relative_difference(a: Estimate, b: Estimate, channel: int) -> float:
    """By what part of b the mean of a is greater."""
    return float(a.mean[channel] / b.mean[channel] - 1) if b.mean[channel] else float(a.mean[channel])
