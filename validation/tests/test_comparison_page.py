"""The page of a comparison: it shows what it is given and obeys none of it."""

import re
from html.parser import HTMLParser

import numpy as np
from markupsafe import escape

import tyndall
from tyndall.failure import Failure
from tyndall.judging import Measured, Verdict, judge
from tyndall.scene import Scene
from validation import comparison_page
from validation.compare import Effort

EVIL = "<script>alert('x')</script>\"><img src=http://evil.example/x.png>"


class Reader(HTMLParser):
    """Gathers the tags and the text of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.text += data


def verdict(name: str) -> Verdict:
    """Of two small stacks of noise."""
    ours, theirs = (Measured.of(np.random.default_rng(seed).uniform(0.5, 1, (8, 6, 8, 3))) for seed in (1, 2))
    return judge(name, "pt", ours, theirs, 1.5)


def page() -> str:
    """With evil in all that users can name."""
    found: dict[str, Verdict | Failure] = {EVIL: verdict(EVIL), "lt": Failure(EVIL, EVIL)}
    return comparison_page.html(comparison_page.page(Scene({}, EVIL), Effort(8, 4), found))


def test_text_is_shown_and_not_obeyed() -> None:
    reader = Reader()
    reader.feed(page())
    assert not [tag for tag, _ in reader.tags if tag in ("script", "iframe", "object", "link")]
    assert reader.text.count("<script>alert('x')</script>") >= 4
    sources = [attributes["src"] or "" for tag, attributes in reader.tags if tag == "img"]
    assert len(sources) == 4 and all(source.startswith("data:image/png;base64,") for source in sources)
    assert not [name for _, attributes in reader.tags for name in attributes if name.startswith("on")]


def test_the_page_needs_no_network() -> None:
    outside = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", page()).replace(escape(EVIL), "")
    assert not re.search(r"""(src|href)=["']?(?!"")(https?:|//)|@import|url\(""", outside)


def test_numbers_stand_in_the_table() -> None:
    text = page()
    found = verdict(EVIL)
    for shown in (f"{found.image_score:+.2f}", f"{100 * found.accepted:.2f} %", "1.5", "not known", "CANNOT"):
        assert shown in text


def test_flip_is_zero_for_equal_images_only_and_grows() -> None:
    image = np.random.default_rng(3).uniform(0, 3, (24, 32, 3))
    none, some, more = (tyndall.diff(image * factor, image)["flip"] for factor in (1, 1.1, 1.5))
    assert none == 0 < some < more < 1


def test_flip_survives_black_and_uniform_references() -> None:
    black, grey = np.zeros((8, 8, 3)), np.full((8, 8, 3), 0.5)
    half = np.where(np.arange(8)[:, None, None] < 6, 0, grey)
    for reference in (black, grey, half):
        assert tyndall.diff(reference, reference)["flip"] == 0
        assert tyndall.diff(grey + 0.1, reference)["flip"] > 0
