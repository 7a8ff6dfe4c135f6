"""The page of a study in a headless browser: it loads without errors or requests, and its controls work."""

import re
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import get_args

import numpy as np
from playwright.sync_api import Browser, Error, FloatRect, Locator, Page

from tyndall.failure import Failure
from validation import mitsuba
from validation.browser import Opened, Scheme, chromium, opened, running

DESKTOP, PHONE = (1280, 900), (375, 800)
WIDTHS = (320, 375, 768, 1280, 1920)
Finding = tuple[str, str]
"""A claim, and what speaks against it; nothing where it holds."""


def run(file: Path, output: Path, if_possible: bool) -> bool:
    """Prints a line for every claim; true if all hold. `if_possible`: true also where there is no browser, and says so."""
    if if_possible and chromium() is None:
        print("skipped: no Chromium was found, the page was not looked at", file=sys.stderr)
        return True
    if not file.is_file():
        raise Failure(f"{file}: no such file", "make it: tyndall report FOLDER")
    output.mkdir(parents=True, exist_ok=True)
    with running() as browser:
        return all([told(finding) for finding in findings(browser, file, output)])


def told(finding: Finding) -> bool:
    """Prints a line."""
    claim, objection = finding
    print(f"{claim:<76} {f'FAILED: {objection}' if objection else 'ok'}", flush=True)
    return not objection


def findings(browser: Browser, file: Path, output: Path) -> Iterator[Finding]:
    """All of them."""
    with opened(browser, file, *DESKTOP) as desktop:
        scenes = desktop.page.locator(".scene").all()
        yield "there is a scene", "" if scenes else "none"
        for scene in scenes:
            yield from of_scene(desktop.page, scene)
        yield "the console stays silent", "; ".join(desktop.complaints)
        yield "nothing is asked for but the page itself", "; ".join(foreign(desktop, file))
    for scheme in get_args(Scheme):
        for name, size in (("desktop", DESKTOP), ("phone", PHONE)):
            yield from of_picture(browser, file, size, scheme, output / f"{file.stem}_{name}_{scheme}.png")
    for width in WIDTHS:
        with opened(browser, file, width, 800) as narrow:
            yield f"nothing sticks out of a window {width} wide", overflow(narrow.page)
    with opened(browser, file, 800, 1100) as paper:
        paper.page.emulate_media(media="print")
        yield "nothing sticks out of a sheet of paper", overflow(paper.page)


def foreign(opened: Opened, file: Path) -> list[str]:
    """What was asked for besides the page and what it holds itself."""
    own = (file.resolve().as_uri(), "data:")
    return [url[:100] for url in opened.requests if not url.startswith(own)]


def overflow(page: Page) -> str:
    """By how much the page is wider than its window, and one thing that is."""
    return page.evaluate(
        """() => {
        const room = document.documentElement.clientWidth;
        if (document.documentElement.scrollWidth <= room) return "";
        const out = [...document.querySelectorAll("body *")].find((e) => e.getBoundingClientRect().right > room + 1);
        return `${document.documentElement.scrollWidth - room} pixels; ${out?.tagName} ${out?.className}`;
    }"""
    )


def of_picture(browser: Browser, file: Path, size: tuple[int, int], scheme: Scheme, picture: Path) -> Iterator[Finding]:
    """The whole page as a picture, that somebody may look at."""
    with opened(browser, file, *size, scheme) as page:
        page.page.screenshot(path=picture, full_page=True)
    yield f"{picture.name} shows something", blank(picture)


def blank(picture: Path) -> str:
    """Why a picture cannot be a page with curves and images."""
    seen = pixels(picture.read_bytes())[::3, ::3].astype(np.uint32)
    colours = len(np.unique(seen @ np.array([1 << 16, 1 << 8, 1], dtype=np.uint32)))
    return f"only {colours} colours" if colours < 100 else ""


def pixels(png: bytes) -> np.ndarray:
    """Of a picture, 8 bits a channel."""
    mi = mitsuba.package()
    mi.set_variant("scalar_rgb")
    stream = mi.MemoryStream()
    stream.write(png)
    stream.seek(0)
    return np.array(mi.Bitmap(stream))[:, :, :3]


def of_scene(page: Page, scene: Locator) -> Iterator[Finding]:
    """What can be done with a scene."""
    name = scene.locator("h2").inner_text()
    checks: tuple[tuple[str, Callable[[Page, Locator], str]], ...] = (
        ("every switch shows its own curves", switches),
        ("the legend hides curves and brings them back", legend),
        ("a point tells its numbers", tells),
        ("arrow keys go from point to point", arrows),
        ("every level of time shows its own images", levels),
        ("exposure changes the light", exposure),
        ("images are zoomed and moved together", zooms),
        ("the compare slider follows its value", slides),
        ("the compare slider follows the pointer", drags),
        ("the compare slider follows the keyboard", keys),
        ("any image can be compared", selects),
    )
    for claim, check in checks:
        yield f"{name}: {claim}", against(check, page, scene)


def against(check: Callable[[Page, Locator], str], page: Page, scene: Locator) -> str:
    """What a check has against the page; a control that cannot be used counts too."""
    try:
        return check(page, scene)
    except Error as error:
        return error.message.splitlines()[0]


def choices(scene: Locator, kind: str) -> list[str]:
    """The values of a switch."""
    return [radio.get_attribute("value") or "" for radio in scene.locator(f'input[name^="{kind}-"]').all()]


def choose(scene: Locator, kind: str, value: str) -> None:
    """As a user does, who sees the label and not the button."""
    scene.locator(f'label:has(input[name^="{kind}-"][value="{value}"])').click()


def switches(page: Page, scene: Locator) -> str:
    """One chart at a time, that of the switches."""
    for measure in choices(scene, "measure"):
        for axis in choices(scene, "axis"):
            choose(scene, "measure", measure)
            choose(scene, "axis", axis)
            shown = [chart for chart in scene.locator(".chart").all() if chart.is_visible()]
            found = [(chart.get_attribute("data-measure"), chart.get_attribute("data-axis")) for chart in shown]
            if found != [(measure, axis)]:
                return f"{found} for {measure}, {axis}"
    choose(scene, "measure", choices(scene, "measure")[0])
    choose(scene, "axis", choices(scene, "axis")[0])
    return ""


def legend(page: Page, scene: Locator) -> str:
    """Each button its own curve."""
    for button in scene.locator(".legend button").all():
        curve = scene.locator(f'.chart:visible .series[data-series="{button.get_attribute("data-series")}"]')
        seen = [curve.is_visible()]
        for _ in range(2):
            button.click()
            seen.append(curve.is_visible())
        if seen != [True, False, True]:
            return f"{button.inner_text()}: {seen}"
    return ""


def first_mark(scene: Locator) -> Locator:
    """Of the first contender."""
    return scene.locator(".chart:visible .series .marks > *").first


def tells(page: Page, scene: Locator) -> str:
    """The pointer over a mark."""
    scene.locator(".frame").scroll_into_view_if_needed()
    page.mouse.move(*middle(first_mark(scene)))
    tip = scene.locator(".tip")
    said = tip.inner_text() if tip.is_visible() else ""
    page.mouse.move(0, 0)
    if not re.search(r" s, .* spp\n.*relMSE .*\[.*\]", said):
        return f'"{said}"'
    return "it stays" if tip.is_visible() else ""


def arrows(page: Page, scene: Locator) -> str:
    """Right and right again tells of the second point, if there is one."""
    scene.locator(".frame").focus()
    said = []
    for key in ("ArrowRight", "ArrowRight", "Escape"):
        page.keyboard.press(key)
        said.append(scene.locator(".tip").inner_text() if scene.locator(".tip").is_visible() else "")
    points = scene.locator(".chart:visible .series").first.locator(".marks > *").count()
    works = said[0] and (said[0] != said[1]) == (points > 1) and not said[2]
    return "" if works else str(said)


def levels(page: Page, scene: Locator) -> str:
    """One strip at a time, all images of it complete."""
    for level in choices(scene, "level"):
        choose(scene, "level", level)
        shown = [strip.get_attribute("data-level") for strip in scene.locator(".strip").all() if strip.is_visible()]
        if shown != [level]:
            return f"{shown} for {level}"
    empty = scene.locator(".view img").evaluate_all("images => images.filter(i => !(i.complete && i.naturalWidth)).length")
    return f"{empty} images do not load" if empty else ""


def exposure(page: Page, scene: Locator) -> str:
    """Brighter is brighter, on the screen."""
    view = scene.locator(".strip:visible .view").first
    slider = scene.locator("input.exposure")
    sums = []
    for stops in ("0", "3", "0"):
        slider.fill(stops)
        sums.append(float(pixels(view.screenshot()).mean()))
    return "" if sums[0] == sums[2] and (sums[1] > sums[0] or sums[1] == 0) else str(sums)


def place(thing: Locator) -> FloatRect:
    """On the screen."""
    box = thing.bounding_box()
    if box is None:
        raise Error("what should be seen is hidden")
    return box


def middle(thing: Locator) -> tuple[float, float]:
    """On the screen."""
    box = place(thing)
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def boxes(scene: Locator) -> list[tuple[float, float, float]]:
    """How large images are, and where in their views."""
    return scene.locator(".strip:visible .view img").evaluate_all(
        """images => images.map(image => {
            const [inner, outer] = [image, image.closest(".view")].map(e => e.getBoundingClientRect());
            return [inner.width / outer.width, (inner.x - outer.x) / outer.width, (inner.y - outer.y) / outer.height];
        })"""
    )


def alike(found: Sequence[tuple[float, ...]]) -> bool:
    """True if all have the same numbers."""
    return bool(np.allclose(found, found[0], atol=0.02))


def zooms(page: Page, scene: Locator) -> str:
    """By a click, the wheel, a drag; back by the keyboard."""
    view = scene.locator(".strip:visible .view").last
    view.scroll_into_view_if_needed()
    view.click()
    clicked = boxes(scene)
    x, y = middle(view)
    page.mouse.move(x, y)
    page.mouse.wheel(0, -100)
    page.wait_for_function(
        "before => document.querySelector('.zoomed').style.getPropertyValue('--zoom') != before", arg="2", timeout=5000
    )
    wheeled = boxes(scene)
    drag(page, (x, y), (x + 20, y + 10))
    dragged = boxes(scene)
    scene.locator(".images").focus()
    page.keyboard.press("0")
    whole = boxes(scene)
    steps = [found[0] for found in (clicked, wheeled, dragged, whole)]
    together = all(alike(found) for found in (clicked, wheeled, dragged, whole))
    grown = 1.9 < steps[0][0] < 2.1 < steps[1][0] and steps[2][1] > steps[1][1] and steps[3] == [1, 0, 0]
    return "" if together and grown else f"{steps}{'' if together else ', not together'}"


def drag(page: Page, start: tuple[float, float], end: tuple[float, float]) -> None:
    """With the button down, in a few steps."""
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=5)
    page.mouse.up()


def cut(scene: Locator) -> tuple[float, float]:
    """What the slider says, and how much of the left image is seen [%]."""
    value = float(scene.locator("input.cut").input_value())
    clip = scene.locator(".stage .layer.left").evaluate("layer => getComputedStyle(layer).clipPath")
    hidden = re.fullmatch(r"inset\(0px (?:calc\(100% - ([\d.]+)%\)|([\d.]+)%) 0px 0px\)", clip)
    if not hidden:
        raise Failure(f"clip-path is {clip}", "see how style.css words it now, and adapt `cut`")
    kept, gone = hidden.groups()
    return value, float(kept) if kept else 100 - float(gone)


def is_at(found: tuple[float, float], wanted: float) -> str:
    """Both at about the same."""
    return "" if np.allclose(found, wanted, atol=1.5) else f"{found} for {wanted}"


def slides(page: Page, scene: Locator) -> str:
    """Set, and the picture on the screen is another."""
    stage, slider = scene.locator(".stage"), scene.locator("input.cut")
    pictures = []
    for value in ("0", "20", "100"):
        slider.fill(value)
        pictures.append(stage.screenshot())
        if wrong := is_at(cut(scene), float(value)):
            return wrong
    return "the picture stays the same" if pictures[0] == pictures[2] else ""


def drags(page: Page, scene: Locator) -> str:
    """From a third to three quarters."""
    stage = scene.locator(".stage")
    stage.scroll_into_view_if_needed()
    box = place(stage)
    at = [(box["x"] + share * box["width"], box["y"] + box["height"] / 2) for share in (0.33, 0.75)]
    drag(page, *at)
    return is_at(cut(scene), 75)


def keys(page: Page, scene: Locator) -> str:
    """An arrow is a step."""
    scene.locator("input.cut").fill("50")
    scene.locator("input.cut").press("ArrowRight")
    value, seen = cut(scene)
    return "" if 50 < value == seen else f"{value}, {seen}"


def selects(page: Page, scene: Locator) -> str:
    """Every choice shows an image of its name."""
    for side in ("left", "right"):
        select = scene.locator(f"select.{side}")
        for option in select.locator("option").all_inner_texts():
            select.select_option(label=option)
            label = scene.locator(f".label.{side}").inner_text()
            if label != option or not scene.locator(f".stage .layer.{side} img").evaluate("image => image.src.length > 50"):
                return f"{label} for {option}"
    return ""
