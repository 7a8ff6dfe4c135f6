"""The page of `tyndall view` in a headless browser: it shows a scene, the camera follows the hand, and it reads what is saved."""

import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import get_args

from playwright.sync_api import Browser, Error, Page

from tyndall import program
from tyndall.failure import Failure
from validation.browser import Opened, Scheme, chromium, running, visited
from validation.page import DESKTOP, PHONE, Finding, blank, drag, middle, overflow, pixels, told
from validation.places import SCENES

SCENE = SCENES / "foggy_room.json"
SIZE = "256x192"
PATIENCE = 60_000
"""How long a picture may take to come [ms]."""


def run(output: Path, if_possible: bool) -> bool:
    """Prints a line for every claim; true if all hold. `if_possible`: true also where there is no browser, and says so."""
    if if_possible and chromium() is None:
        print("skipped: no Chromium was found, the page was not looked at", file=sys.stderr)
        return True
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="tyndall-") as folder, running() as browser:
        scene = Path(folder, SCENE.name)
        shutil.copy(SCENE, scene)
        with serving(scene) as address:
            return all([told(finding) for finding in findings(browser, address, scene, output)])


@contextmanager
def serving(scene: Path) -> Iterator[str]:
    """The address of a view of `scene`, ended as by Ctrl-C."""
    command = [str(program.binary()), "view", str(scene), "--size", SIZE]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=program.environment()) as process:
        try:
            address = process.stdout.readline().strip() if process.stdout else ""
            if not address:
                raise Failure("tyndall view printed no address", "see what it says above")
            yield address
        finally:
            process.send_signal(signal.SIGINT)


def findings(browser: Browser, address: str, scene: Path, output: Path) -> Iterator[Finding]:
    """All of them."""
    with visited(browser, address, *DESKTOP) as desktop:
        for claim, check in CHECKS:
            yield claim, against(check, desktop.page)
        yield "a scene with a mistake is told, and a saved one shown", against(lambda page: saves(page, scene), desktop.page)
        yield "the console stays silent", "; ".join(desktop.complaints)
        yield "nothing is asked for but from the program", "; ".join(foreign(desktop, address))
    for scheme in get_args(Scheme):
        for name, size in (("desktop", DESKTOP), ("phone", PHONE)):
            picture = output / f"view_{name}_{scheme}.png"
            with visited(browser, address, *size, scheme) as page:
                shown(page.page)
                page.page.screenshot(path=picture, full_page=True)
                yield f"nothing sticks out of a window {size[0]} wide, {scheme}", overflow(page.page)
            yield f"{picture.name} shows something", blank(picture)


def foreign(opened: Opened, address: str) -> list[str]:
    """What was asked for from elsewhere."""
    return [url[:100] for url in opened.requests if not url.startswith((address, "data:"))]


def against(check: Callable[[Page], str], page: Page) -> str:
    """What a check has against the page; what cannot be done counts too."""
    try:
        return check(page)
    except Error as error:
        return error.message.splitlines()[0]


def shown(page: Page, said: str = "") -> None:
    """Waits for a picture of which `said` is said."""
    page.wait_for_function("said => Number(picture.dataset.number) > 0 && document.getElementById('said').textContent.includes(said)", arg=said, timeout=PATIENCE)


def numbered(page: Page, after: int) -> None:
    """Waits for the picture after the one of that number."""
    page.wait_for_function("after => Number(picture.dataset.number) > after", arg=after, timeout=PATIENCE)


def state(page: Page) -> tuple[int, str, float]:
    """The number of the picture, the lines of the camera, and how bright the picture is."""
    number = int(page.locator("#picture").get_attribute("data-number") or 0)
    return number, page.locator("#camera").inner_text(), float(pixels(page.locator("#picture").screenshot()).mean())


def comes(page: Page) -> str:
    """The first picture is there, and refines."""
    shown(page, "samples/pixel in")
    _, camera, light = state(page)
    return "" if light > 5 and '"origin": [0.1, 1.35, 2.85]' in camera else f"{light}, {camera}"


def moves(do: Callable[[Page, tuple[float, float]], None]) -> Callable[[Page], str]:
    """A check that the camera and the picture change by what is done in the middle of the picture."""

    def check(page: Page) -> str:
        page.locator("#picture").scroll_into_view_if_needed()
        # All that was done before is in the picture, once that is as large as it will be.
        shown(page, "samples/pixel in")
        before = state(page)
        picture = page.locator("#picture").screenshot()
        do(page, middle(page.locator("#picture")))
        page.wait_for_function("before => camera.textContent !== before", arg=before[1], timeout=PATIENCE)
        numbered(page, before[0])
        return "the picture stays the same" if page.locator("#picture").screenshot() == picture else ""

    return check


def orbits(page: Page, at: tuple[float, float]) -> None:
    """The button held; not so far that the camera leaves the room."""
    drag(page, at, (at[0] + 12, at[1] + 4))


def pans(page: Page, at: tuple[float, float]) -> None:
    """Shift held as well."""
    page.keyboard.down("Shift")
    drag(page, at, (at[0] + 20, at[1]))
    page.keyboard.up("Shift")


def dollies(page: Page, at: tuple[float, float]) -> None:
    """The wheel."""
    page.mouse.move(*at)
    page.mouse.wheel(0, -200)


def steps(page: Page, at: tuple[float, float]) -> None:
    """Keys."""
    page.locator("#picture").focus()
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("w")


def goes_home(page: Page, at: tuple[float, float]) -> None:
    """A button."""
    page.locator("#home").click()


def looks(page: Page) -> str:
    """Exposure and view change the picture, not the camera."""
    shown(page, "samples/pixel in")
    lines, found = state(page)[1], []
    for stops in ("0", "3"):
        number = state(page)[0]
        page.locator("#exposure").fill(stops)
        numbered(page, number)
        found.append(state(page)[2])
    number = state(page)[0]
    page.locator("#view").select_option("linear")
    numbered(page, number)
    found.append(state(page)[2])
    return "" if found[0] < found[1] < found[2] and state(page)[1] == lines else str(found)


def copies(page: Page) -> str:
    """The lines are what the clipboard gets."""
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.locator("#copy").click()
    got = page.evaluate("navigator.clipboard.readText()")
    return "" if got == page.locator("#camera").inner_text() else f'"{got}"'


def saves(page: Page, scene: Path) -> str:
    """A broken file, then a whole one."""
    whole = scene.read_text()
    scene.write_text(whole.replace('"bdpt"', '"bdtp"', 1))
    error = page.locator("#error")
    error.wait_for(state="visible", timeout=PATIENCE)
    said = error.inner_text()
    scene.write_text(whole)
    error.wait_for(state="hidden", timeout=PATIENCE)
    return "" if "bdtp" in said and "remedy:" in said else f'"{said}"'


CHECKS: tuple[tuple[str, Callable[[Page], str]], ...] = (
    ("a picture comes and refines", comes),
    ("dragging turns the camera", moves(orbits)),
    ("dragging with Shift moves it sideways", moves(pans)),
    ("the wheel brings it nearer", moves(dollies)),
    ("keys turn and move it", moves(steps)),
    ("a button brings it back", moves(goes_home)),
    ("exposure and view change the picture", looks),
    ("a button copies the lines of the camera", copies),
)
