"""How a scene is traced where its document leaves that open: a pilot of a few samples decides.

docs/decisions/0062: `nocturne-trace --pilot` traces a small part of the render's samples by each method that
applies, and compares errors for the same cost. Costs are counted, not timed, so that the choice, like the
image, is a function of scene, film and samples.
"""

import json
import math
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from nocturne.v1 import scene_pb2

from nocturne_scene.compile.environment import has_sky
from nocturne_scene.compile.fluorescence import fluoresces
from nocturne_scene.compile.polarisation import is_polarised
from nocturne_scene.compile.trace_program import run_trace
from nocturne_scene.compile.unmet import unmet_light, unmet_parts
from nocturne_scene.document.checks import CAMERAS, MET_BY_PHOTONS
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.errors import InputError
from nocturne_scene.film import Film
from nocturne_scene.programs import find_program
from nocturne_scene.render_warnings import RenderWarning, WarningKind
from nocturne_scene.scene_ranges import schedule_of
from nocturne_scene.uncertainty import CONFIDENCE

WORTH_A_PILOT = 2**18
"""Samples of a whole film: five times what a pilot takes at least. With fewer it is asked only whether light
is missed, where surfaces may gather it: an error of such an image may be small, too."""

MAX_SECONDS = 120.0
"""After which a pilot is given up."""

_AIMED = 0.6
"""Part of the photons from luminaires that goes to what a person declared important (docs/decisions/0130)."""

PARTS = "parts"
"""As `nocturne-trace --pilot` takes it: the method is known; where in the image may it miss light?"""

SKY = "sky"
"""The same: which part of the sky is visible from where?"""

GUIDED = "guided by what was learned"
"""Part of the sentence about a guided method."""

_WELL_KNOWN = 0.35
"""Standard error of a gain's logarithm, up to which it is shown: its 95 % interval is from half to twice."""

DIRECTIONS = {
    "adjoint": scene_pb2.DIRECTION_ADJOINT,
    "forward": scene_pb2.DIRECTION_FORWARD,
    "both": scene_pb2.DIRECTION_BOTH,
}
_SAID = {
    "adjoint": "photons from the sensor",
    "forward": "photons from the luminaires",
    "both": "photons from both directions",
}


@dataclass(frozen=True)
class Ways:
    """How photons are traced; where nobody says anything, as this has it."""

    direction: str = "adjoint"
    sharing: int = 1
    aimed_emission: float = 0.0
    aims: tuple[scene_pb2.ImportantShape, ...] = ()
    """What these photons are aimed at, where that was learned and not declared."""
    learned_light: bytes = b""
    """Where light was found to come from, for photons from the sensor, as in CompiledScene."""
    visible_sky: bytes = b""
    """Where these photons met the sky, as in CompiledScene."""
    forward_ratio: float = 1.0
    """Photons from luminaires for each from a pixel, where both directions are traced."""

    def named(self) -> str:
        """In words."""
        shared = f", shared by blocks of {self.sharing} pixels" if self.sharing > 1 else ""
        aimed = ", aimed at what was learned" if self.aims else ""
        guided = f", {GUIDED}" if self.learned_light else ""
        sky = ", that know which sky is visible" if self.visible_sky else ""
        return f"{_SAID[self.direction]}{self._unequal()}{aimed}{guided}{sky}{shared}"

    def _unequal(self) -> str:
        if self.forward_ratio == 1.0 or self.direction != "both":
            return ""
        if self.forward_ratio > 1.0:
            return f" ({self.forward_ratio:g} from the luminaires for each from the sensor)"
        return f" ({1.0 / self.forward_ratio:g} from the sensor for each from the luminaires)"


@dataclass(frozen=True)
class OpenWays:
    """What a document leaves to a pilot."""

    names: list[str]
    """Names of the open choices, as `nocturne-trace --pilot` takes them; none: no pilot is needed."""
    default: Ways
    """The settings where the pilot finds no better ones."""
    asked: Ways
    """The settings to compile the pilot's scene for: all that it may choose."""


def given_ways(document: SceneDocument) -> Ways:
    """The document's settings, with those of no pilot where it leaves them open."""
    tracing = document.tracing
    return Ways(
        _direction(document),
        1 if tracing.sharing == "auto" or _is_points(document) else tracing.sharing,
        tracing.aimed_emission or 0.0,
        forward_ratio=1.0 if tracing.forward_ratio == "auto" else tracing.forward_ratio,
    )


def _direction(document: SceneDocument) -> str:
    if document.tracing.direction != "auto":
        return document.tracing.direction
    return "forward" if document.ray_files else "adjoint"


def open_ways(
    document: SceneDocument, scene: scene_pb2.CompiledScene, film: Film, *, photons_can_start: bool
) -> OpenWays:
    """What a pilot is to choose. `photons_can_start`: at all luminaires."""
    tracing, default = document.tracing, given_ways(document)
    small = film.all_samples < WORTH_A_PILOT
    gathers = film.samples > 1 and may_gather(scene)
    if small and not gathers:
        return OpenWays([], default, default)
    names, asked = [PARTS] if gathers and (scene.luminaires or has_sky(scene)) else [], default
    may_forward = tracing.direction == "auto" and photons_can_start and not document.ray_files
    with_forward = _forward(document, scene, film) if may_forward else None
    if with_forward is not None:
        names.append("direction")
        if tracing.forward_ratio == "auto" and with_forward == "both":
            names.append("ratio")
        # Photons from the sensor are aimed at nothing, and alone.
        default = replace(default, aimed_emission=0.0, forward_ratio=1.0)
        aimed = tracing.aimed_emission or 0.0
        if tracing.aimed_emission is None and scene.important_shapes:
            names.append("aim")
            aimed = _AIMED
        elif tracing.aimed_emission is None and (scene.luminaires or has_sky(scene)):
            names.append("learn")
        asked = replace(asked, direction=with_forward, aimed_emission=aimed)
    if small:
        return OpenWays(names, default, asked)
    if tracing.guide == "auto" and asked.direction == "both":
        names.append("guide")
    connects = tracing.estimator == "two_photons"
    if (
        tracing.guide == "auto"
        and connects
        and tracing.direction != "forward"
        and scene.HasField("environment")
    ):
        names.append(SKY)
    plain = fluoresces(scene.kernels, scene.media) or is_polarised(scene, [*scene.kernels])
    may_share = connects and not _is_points(document) and not plain
    if tracing.sharing == "auto" and may_share and asked.direction != "forward":
        names.append("sharing")
    return OpenWays(names, default, asked)


def _is_points(document: SceneDocument) -> bool:
    """Whether neighbours on the film may be far apart, so that they have no light in common."""
    return document.sensor.type == "meters"


_SPREAD = {"lambertian", "fluorescent", "diffuse_transmitter", "null_kernel", "polarising_filter", "blend"}
"""Kernels that send light to all sides, or on as if nothing were there, and mixtures of others."""


def may_gather(scene: scene_pb2.CompiledScene) -> bool:
    """Whether surfaces may gather light, so that photons from the sensor meet little of it, or none. Which of
    them do is the tracer's to say: its pilot then has nothing to look for."""
    return any(kernel.WhichOneof("model") not in _SPREAD for kernel in scene.kernels)


def _forward(document: SceneDocument, scene: scene_pb2.CompiledScene, film: Film) -> str | None:
    """How photons from luminaires could take part; None: not at all."""
    kind = document.sensor.type
    direction = "both" if kind in CAMERAS else "forward" if kind in MET_BY_PHOTONS else None
    if direction is None:
        return None
    traced_so = scene_pb2.CompiledScene(sensor=scene.sensor, tracing=scene.tracing)
    traced_so.tracing.direction = DIRECTIONS[direction]
    try:
        schedule_of(traced_so, film.width, film.height, film.samples)
    except InputError:
        return None
    return direction


def choose(
    scene: scene_pb2.CompiledScene, blobs: Path, film: Film, ways: OpenWays
) -> tuple[Ways, str, list[RenderWarning]]:
    """The better ones; how that was found, in a sentence, empty where nothing was to be chosen; and what the
    image may not show. `scene` is compiled for `left_open.asked`.

    Without nocturne-trace, or where it fails, nothing is chosen, and the sentence says so.
    """
    default, asked = ways.default, ways.asked
    program = find_program("nocturne-trace")
    if program is None:
        return default, f"{default.named()}: nothing was compared, as nocturne-trace is missing here", []
    try:
        found = _run(program, scene, blobs, film, ways.names)
        learned = tuple(_aim(each) for each in found["aims"])
        better = Ways(
            asked.direction if found["forward_photons"] else default.direction,
            int(found["sharing"]) if "sharing" in ways.names else asked.sharing,
            _aimed(found, ways),
            learned,
            bytes.fromhex(found["learned_light"]),
            bytes.fromhex(found["visible_sky"]),
            _ratio(found, ways),
        )
        told = [
            unmet_light(found["unmet"], asked.direction),
            unmet_parts(found["unmet_parts"]),
            _fault(found["fault"], found["differs_by"]),
        ]
        warnings = [each for each in told if each is not None]
        return better, "" if not {*ways.names} - {PARTS, SKY} else _sentence(better, default, found), warnings
    except (OSError, subprocess.SubprocessError, ValueError, KeyError):
        return default, f"{default.named()}: nothing was compared, as the pilot failed", []


def _ratio(found: Mapping[str, Any], ways: OpenWays) -> float:
    if not found["forward_photons"]:
        return ways.default.forward_ratio
    ratio: float = found["forward_ratio"] if "ratio" in ways.names else ways.asked.forward_ratio
    return ratio


def _aimed(found: Mapping[str, Any], ways: OpenWays) -> float:
    part: float = found["aimed"]
    if "aim" in ways.names or "learn" in ways.names:
        return part
    # The pilot has rounded what the document says.
    return ways.asked.aimed_emission if part else 0.0


def _aim(found: Mapping[str, Any]) -> scene_pb2.ImportantShape:
    x, y, z = found["centre"]
    ball = scene_pb2.Sphere(centre=scene_pb2.Vector(x=x, y=y, z=z), radius=found["radius"])
    return scene_pb2.ImportantShape(sphere=ball, weight=found["weight"])


def _run(
    program: Path, scene: scene_pb2.CompiledScene, blobs: Path, film: Film, chosen: list[str]
) -> dict[str, Any]:
    words = ["--pilot", ",".join(chosen)]
    found: dict[str, Any] = json.loads(run_trace(program, scene, blobs, film, words, MAX_SECONDS))
    return found


def _fault(which: str, differs_by: float) -> RenderWarning | None:
    """The warning where two methods' means differ beyond their errors; None where none do."""
    what = {"guided": "photons that are guided", "shared": "pixels that share"}.get(which)
    if what is None:
        return None
    return RenderWarning(
        WarningKind.FAULT,
        f"{what} brought {abs(differs_by):.0%} {'more' if differs_by > 0 else 'less'} light than others in "
        "the pilot, beyond their errors, and were not chosen: this is a fault of the program, please report "
        "the scene",
    )


def _sentence(ways: Ways, default: Ways, found: dict[str, Any]) -> str:
    tried = f"by a pilot of {found['photons']:,} photons"
    if replace(ways, visible_sky=b"") == default:
        return f"{ways.named()}: no other method was found better {tried}"
    if found["finds_more"]:
        return f"{ways.named()}: {default.named()} missed light that these found, {tried}"
    gain = found["gain"]
    if gain <= 1.0:
        # Or guided photons showed the noise of light that the default had not met.
        return f"{ways.named()}: about as much error as by {default.named()}, which may miss light, {tried}"
    times = _times(gain, found["gain_error"])
    return f"{ways.named()}: {times}less time to the same error than by {default.named()}, {tried}"


def _times(gain: float, error: float) -> str:
    """`error`: standard error of the gain's logarithm. Nothing where the gain is hardly known."""
    if error > _WELL_KNOWN:
        return ""
    low, high = gain * math.exp(-CONFIDENCE * error), gain * math.exp(CONFIDENCE * error)
    return f"{low:.2g} to {high:.2g} times "
