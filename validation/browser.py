"""A headless Chromium, whichever is installed, and what a page in it complained of."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from playwright.sync_api import Browser, Page, sync_playwright

from tyndall.failure import Failure

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def chromium() -> str | None:
    """Where it is: $TYNDALL_CHROMIUM, else on the PATH; None where there is none."""
    named = os.environ.get("TYNDALL_CHROMIUM")
    if named and shutil.which(named) is None:
        raise Failure(f"TYNDALL_CHROMIUM={named}: no such program", "name Chromium or Chrome, or leave it unset")
    return named or next(filter(None, map(shutil.which, NAMES)), None)


@contextmanager
def running() -> Iterator[Browser]:
    """The browser, closed at the end."""
    program = chromium()
    if program is None:
        raise Failure("no Chromium was found", f"install it ({', '.join(NAMES)}), or set TYNDALL_CHROMIUM to one")
    # its sandbox refuses root
    arguments = ["--no-sandbox"] if os.geteuid() == 0 else []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=arguments)
        yield browser
        browser.close()


Scheme = Literal["light", "dark"]
"""What a reader prefers."""


@dataclass(frozen=True)
class Opened:
    """A page, and all that it said or asked for."""

    page: Page
    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@contextmanager
def opened(browser: Browser, file: Path, width: int, height: int, scheme: Scheme = "light") -> Iterator[Opened]:
    """The page at a size of window [CSS pixels], without a network."""
    with visited(browser, file.resolve().as_uri(), width, height, scheme, offline=True) as page:
        yield page


@contextmanager
def visited(browser: Browser, address: str, width: int, height: int, scheme: Scheme = "light", offline: bool = False) -> Iterator[Opened]:
    """The page at an address."""
    context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme, offline=offline)
    result = Opened(context.new_page())
    result.page.on("console", lambda message: result.complaints.append(f"{message.type}: {message.text}"))
    result.page.on("pageerror", lambda error: result.complaints.append(str(error)))
    result.page.on("request", lambda request: result.requests.append(request.url))
    result.page.goto(address)
    yield result
    context.close()
