"""The gallery: renders its scenes by their own commands, measures their error, gives Mitsuba the same seconds, and renews the
table of scenes/GALLERY.md."""

import argparse
import json
import os
import re
import shlex
import shutil
import sys
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

import tyndall
from tyndall import exr, program
from tyndall.failure import Failure
from validation import mitsuba
from validation.animation import animation, still
from validation.files import write_text
from validation.places import OUTPUT, ROOT, SCENES

FOLDER = SCENES / "gallery"
ENTRIES = FOLDER / "gallery.json"
MEASURED = FOLDER / "measured.json"
PAGE = SCENES / "GALLERY.md"
TABLE = re.compile(r"(?<=<!-- gallery -->\n).*?(?=<!-- end -->)", re.DOTALL)
PILOT = 1
"""Samples per pixel by which Mitsuba's time is first known,"""
FASTER = 16
"""more of them at most at a time, as the first ones take longer,"""
CLOSE = 0.75
"""until it takes so much of the time of ours,"""
TRIALS = 8
"""or has been tried so often."""
VIEW = {"--exposure", "--view"}
"""Options that Mitsuba's picture is shown by too."""
OTHER_SEED = 1
"""Of the second render: the difference of both is their error."""
FEWER = 1 / 8
"""Its samples over those of the first."""
DENOISE = "--denoise"
"""Pictures of commands with it are large, and JPEG files with a smaller one for the table; they are measured as they are before."""
QUALITY = 88
"""Of JPEG files: what they lose is not seen beside what a denoiser loses."""
NOISY_QUALITY = 70
"""Of Mitsuba's: most of them are full of noise, which takes most of a file."""
SMALL = 480
"""Pixels across a small picture, twice as many as it is shown by."""


def add_options(command: argparse.ArgumentParser) -> None:
    """Those of the command line."""
    command.add_argument("names", nargs="*", metavar="NAME", help="entries of scenes/gallery/gallery.json (default: all)")
    command.add_argument("--check", action="store_true", help="render nothing: scenes load, commands and pictures are there, the table is current")
    command.add_argument("--table", action="store_true", help="render nothing: only write the table anew")
    command.add_argument("--threads", type=int, default=os.cpu_count(), help="of both renderers alike (default %(default)s)")


def run(options: argparse.Namespace) -> bool:
    """Renders, measures, and writes the table."""
    entries = chosen(options.names)
    if options.check:
        return all([holds(entry) for entry in entries]) & is_current()
    if not options.table:
        for entry in entries:
            renew(entry, options.threads)
    write_text(PAGE, with_table(PAGE.read_text()))
    return True


@dataclass(frozen=True)
class Entry:
    """A picture of the gallery."""

    name: str
    title: str
    shows: str
    after: str
    command: str
    mitsuba: bool
    why_not: str = ""

    @property
    def options(self) -> list[str]:
        """The words of the command after the scene."""
        program, command, _, *options = [*shlex.split(self.command), *3 * [""]]
        if (program, command) != ("tyndall", "render"):
            raise Failure(f"{ENTRIES}: {self.name}: the command is {self.command}", "write `tyndall render scenes/gallery/NAME.json`, then options")
        return list(filter(None, options))

    @property
    def scene(self) -> Path:
        """The scene that the command names."""
        return ROOT / shlex.split(self.command)[2]

    @property
    def parameters(self) -> list[str]:
        """What -D gives."""
        return [word for before, pair in zip(self.options, self.options[1:]) if before == "-D" for word in (before, pair)]

    @property
    def pictures(self) -> list[Path]:
        """Tyndall's, and Mitsuba's if there is one."""
        end = "jpg" if self.is_large else "png"
        return [FOLDER / f"{name}.{end}" for name in (self.name, f"{self.name}.mitsuba")[: 1 + self.mitsuba]]

    @property
    def files(self) -> list[Path]:
        """Those, and the small ones beside them."""
        return [path for picture in self.pictures for path in ((picture, small(picture)) if self.is_large else (picture,))]

    @property
    def is_denoised(self) -> bool:
        """By Open Image Denoise."""
        return DENOISE in self.options

    @property
    def is_large(self) -> bool:
        """One still with a small one beside it."""
        return self.is_denoised and not self.moves

    @property
    def moves(self) -> bool:
        """Of many frames."""
        return "--frames" in self.options


def entries() -> list[Entry]:
    """All of the gallery."""
    return [Entry(name, **fields) for name, fields in json.loads(ENTRIES.read_text()).items()]


def chosen(names: list[str]) -> list[Entry]:
    """Those asked for."""
    all_of_them = entries()
    unknown = set(names) - {entry.name for entry in all_of_them}
    if unknown:
        raise Failure(f"{', '.join(sorted(unknown))}: not in {ENTRIES}", f"name any of {', '.join(entry.name for entry in all_of_them)}")
    return [entry for entry in all_of_them if not names or entry.name in names]


@dataclass(frozen=True)
class Measured:
    """What was found of an entry: seconds of rendering, relMSE, threads; the same of Mitsuba, and by which integrator."""

    seconds: float
    threads: int
    relmse: float | None = None
    mitsuba_seconds: float | None = None
    mitsuba_relmse: float | None = None
    mitsuba_by: str = ""


def renew(entry: Entry, threads: int) -> None:
    """Renders an entry, and Mitsuba's picture beside it."""
    folder = OUTPUT / "gallery" / entry.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    found = animated(entry, threads, folder) if entry.moves else measured(entry, threads, folder)
    known = json.loads(MEASURED.read_text()) if MEASURED.is_file() else {}
    write_text(MEASURED, json.dumps({**known, entry.name: asdict(found)}, indent=1, sort_keys=True) + "\n")
    print(f"{entry.name:24} {found}", flush=True)


def measured(entry: Entry, threads: int, folder: Path) -> Measured:
    """A picture: rendered, and again by another seed with fewer samples."""
    first = rendered(entry.options, entry.scene, threads, folder / "image.exr")
    few = max(1, round(first["samples_per_pixel"] * FEWER))
    rendered(plain(entry.options), entry.scene, threads, folder / "other.exr", seed=OTHER_SEED, spp=few)
    image, other = (exr.read_image(folder / name) for name in ("image.exr", "other.exr"))
    share = first["samples_per_pixel"] / (first["samples_per_pixel"] + few)
    mean = share * image + (1 - share) * other
    keep(folder / ("image.denoised.png" if entry.is_denoised else "image.png"), entry.pictures[0])
    seconds, relmse = first["render_seconds"], relmse_of(image, mean) / (1 - share)
    if not entry.mitsuba:
        return Measured(seconds, threads, relmse)
    kind = "volpathmis" if is_chromatic(entry) else "volpath"
    file, took = by_mitsuba(entry, kind, seconds, threads, folder, image.shape[1::-1])
    shown_as(entry, file, entry.pictures[1])
    return Measured(seconds, threads, relmse, took, max(0, relmse_of(exr.read_image(file), mean) - share * relmse), kind)


def plain(options: list[str]) -> list[str]:
    """The options of a render but --spp and --denoise."""
    return [word for before, word in zip(["", *options], options) if "--spp" not in (before, word) and word != DENOISE]


def keep(png: Path, picture: Path) -> None:
    """Stores a picture in the gallery, without what it says of itself; one in JPEG with a small one beside it."""
    if picture.suffix == ".png":
        picture.write_bytes(still(png.read_bytes()))
        return
    with Image.open(png) as image:
        whole = image.convert("RGB")
    quality = NOISY_QUALITY if ".mitsuba" in picture.suffixes else QUALITY
    whole.save(picture, quality=quality, optimize=True)
    whole.resize((SMALL, round(whole.height * SMALL / whole.width)), Image.Resampling.LANCZOS).save(small(picture), quality=QUALITY, optimize=True)


def small(picture: Path) -> Path:
    """The small one beside it."""
    return picture.with_suffix(f".small{picture.suffix}")


def rendered(options: list[str], scene: Path, threads: int, output: Path, **more: int) -> dict[str, Any]:
    """Runs the command; what it reports: of all frames together, the seconds of rendering."""
    report = output.with_suffix(".json")
    words = program.flags({"output": output, "report": report, "threads": threads, **more})
    program.call([str(program.binary()), "render", str(scene), *options, *words])
    written = json.loads(report.read_text())
    frames = written.get("frames", [written])
    return {**frames[0], "render_seconds": sum(float(frame["render_seconds"]) for frame in frames)}


def relmse_of(image: np.ndarray, reference: np.ndarray) -> float:
    """As `tyndall diff` measures it."""
    return float(tyndall.diff(image, reference)["radiance"]["relmse"])


def is_chromatic(entry: Entry) -> bool:
    """Whether extinction differs between the channels, which volpath has no weights for."""
    media = json.loads(program.call([str(program.binary()), "info", "--json", *entry.parameters, str(entry.scene)]).stdout)["media"]
    return any(len(set(medium["largest_sigma_t"])) > 1 for medium in media)


def by_mitsuba(entry: Entry, kind: str, seconds: float, threads: int, folder: Path, size: tuple[int, ...]) -> tuple[Path, float]:
    """The file of Mitsuba's image after about as many seconds, and the seconds it took: fewer samples tell how many fit."""
    variant = "llvm_ad_rgb" if mitsuba.libllvm() else "scalar_rgb"
    command = [sys.executable, "-m", "validation.contender", str(entry.scene), *entry.parameters, "--integrator", kind, "--variant", variant]
    command += ["--seed", "0", "--size", f"{size[0]}x{size[1]}", "--threads", str(threads), "--folder", str(folder)]
    spp = PILOT
    for trial in range(TRIALS):
        took = float(json.loads(program.call([*command, "--spp", str(spp)]).stdout)["seconds"])
        if took > CLOSE * seconds or trial == TRIALS - 1:
            break
        spp = max(spp + 1, round(spp * min(seconds / took, FASTER)))
    return folder / f"{spp}.exr", took


def animated(entry: Entry, threads: int, folder: Path) -> Measured:
    """A moving picture: its frames are measured by nobody."""
    seconds = rendered(entry.options, entry.scene, threads, folder / "frame.exr")["render_seconds"]
    fps = dict(zip(entry.options, entry.options[1:])).get("--fps", "24")
    entry.pictures[0].write_bytes(animation([path.read_bytes() for path in sorted(folder.glob(f"frame.*{'.denoised' if entry.is_denoised else '[0-9]'}.png"))], float(fps)))
    return Measured(seconds, threads)


def shown_as(entry: Entry, image: Path, picture: Path) -> None:
    """Mitsuba's picture through the exposure and the view transform of ours, and denoised if that is."""
    words, png = entry.options, image.with_suffix(".denoised.png" if entry.is_denoised else ".png")
    view = [word for at, word in enumerate(words) if VIEW & {word.partition("=")[0], *words[at - 1 : at]}]
    made = ["denoise", str(image)] if entry.is_denoised else ["convert", str(image), str(png)]
    program.call([str(program.binary()), *made, *view])
    keep(png, picture)


def holds(entry: Entry) -> bool:
    """Whether the entry's scene loads without a warning, its options exist, and its pictures are there; says what does not hold."""
    wrong = [f"{path} is not there: python3 -m validation gallery {entry.name}" for path in [entry.scene, *entry.files] if not path.is_file()]
    wrong += [f"tyndall render has no option {option}" for option in set(options_of(entry)) - known_options()]
    wrong += warnings(entry) if entry.scene.is_file() else []
    for what in wrong:
        print(f"{entry.name}: {what}")
    return not wrong


def options_of(entry: Entry) -> list[str]:
    """Names of those that the command has."""
    return [word.partition("=")[0] for word in entry.options if word.startswith("--")]


@cache
def known_options() -> set[str]:
    """Of `tyndall render`."""
    return set(re.findall(r"--[a-z][\w-]*", program.call([str(program.binary()), "render", "--help"]).stdout))


def warnings(entry: Entry) -> list[str]:
    """What `tyndall info` says against the scene."""
    try:
        return list(json.loads(program.call([str(program.binary()), "info", "--json", *entry.parameters, str(entry.scene)]).stdout)["warnings"])
    except Failure as failure:
        return [str(failure)]


def is_current() -> bool:
    """Whether the table says what is known; says if not."""
    text = PAGE.read_text()
    if text != with_table(text):
        print(f"{PAGE}: its gallery is not that of gallery.json: python3 -m validation gallery --table")
    return text == with_table(text)


def with_table(text: str) -> str:
    """The page with the table as it should be."""
    known = json.loads(MEASURED.read_text()) if MEASURED.is_file() else {}
    head = ["| picture | shows | command | seconds, relMSE | Mitsuba, in the same seconds |", "|---|---|---|---|---|"]
    rows = [row(entry, Measured(**known[entry.name]) if entry.name in known else None) for entry in entries()]
    table = "".join(f"{line}\n" for line in [*head, *rows])
    if not TABLE.search(text):
        raise Failure(f"{PAGE}: no place for the gallery", "write `<!-- gallery -->` and `<!-- end -->` on lines of their own")
    return TABLE.sub(lambda _: table, text)


def row(entry: Entry, found: Measured | None) -> str:
    """A line of the table."""
    ours = "" if found is None else figures(found.seconds, found.relmse, f" on {found.threads} threads")
    theirs = f"none: {entry.why_not}"
    if entry.mitsuba:
        told = "" if found is None or found.mitsuba_seconds is None else f"<br>{found.mitsuba_by}: {figures(found.mitsuba_seconds, found.mitsuba_relmse)}"
        theirs = shown(entry.pictures[1]) + told
    after = f" ({entry.after})" if entry.after else ""
    denoised = "<br>relMSE before denoising" if entry.is_large else ""
    return f"| {shown(entry.pictures[0])} | **{entry.title}**{after}: {entry.shows} | `{entry.command}` | {ours}{denoised} | {theirs} |"


def figures(seconds: float, relmse: float | None, by: str = "") -> str:
    """Seconds, what took them, and relMSE where it is known."""
    return f"{seconds:.0f} s{by}" + ("" if relmse is None else f", {relmse:.2g}")


def shown(path: Path) -> str:
    """A picture in Markdown; narrow, for both stand in one line. A large one is a link away."""
    name = path.relative_to(SCENES)
    return f'<img src="{name}" width="240">' if path.suffix == ".png" else f'[<img src="{small(name)}" width="240">]({name})'
