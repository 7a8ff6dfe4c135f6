"""Tyndall, a bidirectional path tracer for fog, smoke and fire, from Python:

    import tyndall
    image = tyndall.render("scenes/foggy_room.json", spp=64, size=(320, 240))
    image.save("foggy_room.exr")
"""

from tyndall.arguments import options
from tyndall.commands import diff, info, study
from tyndall.comparing import Comparison, compare
from tyndall.failure import Failure, TyndallWarning
from tyndall.load_dict import from_mitsuba, to_mitsuba
from tyndall.picture import Picture, read
from tyndall.rendering import ALL_STRATEGIES, Rendering, render, render_batches, run
from tyndall.scene import AnyScene, Scene, load

__all__ = [
    "ALL_STRATEGIES",
    "AnyScene",
    "Comparison",
    "Failure",
    "Picture",
    "Rendering",
    "Scene",
    "TyndallWarning",
    "compare",
    "diff",
    "from_mitsuba",
    "info",
    "load",
    "options",
    "read",
    "render",
    "render_batches",
    "run",
    "study",
    "to_mitsuba",
]
