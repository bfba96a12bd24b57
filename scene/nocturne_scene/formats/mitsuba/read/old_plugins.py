"""What single plugins of Mitsuba 0.x say in the words of Mitsuba 3.

Each rule's docstring has its source: a file of Mitsuba 0.6 below src, if no other is named.
"""

from collections.abc import Callable

from nocturne_scene.formats.mitsuba.read.elements import Element, numbers
from nocturne_scene.formats.mitsuba.read.old import Old
from nocturne_scene.formats.mitsuba.read.old_looks import LOOKS
from nocturne_scene.formats.mitsuba.read.old_values import made, said


def _integrator(old: Old) -> None:
    """Nearly all compute the same image: integrators/*; also those of forks, whatever their names."""
    element = old.element
    inside = [child for child in element.children if child.tag == "integrator"]
    if inside:  # adaptive, irrcache: misc/*.cpp
        element.attributes, element.children = dict(inside[0].attributes), inside[0].children
        old.note(f'the integrator around the "{element.type}" is left out')
        return
    if element.type == "direct":
        element.children = [child for child in element.children if child.name == "hide_emitters"]
    elif element.type not in _OTHER_INTEGRATORS:
        if element.type not in ("path", "volpath"):
            old.note(f'light goes as by the integrator "volpath", whatever "{element.type}" does to find it')
        if (strict := old.text("strict_normals", "false")) == "true":
            old.note('"strictNormals" is left out: light reaches both sides of what maps and normals tilt')
        del strict
        element.attributes["type"] = "path" if element.type == "path" else "volpath"
        kept = ("max_depth", "rr_depth", "hide_emitters")
        element.children = [child for child in element.children if child.name in kept]


# Of which the image is another one.
_OTHER_INTEGRATORS = ("ao", "field", "motion", "multichannel", "vpl")


def _sampler(old: Old) -> None:
    """samplers/*: how often a pixel is sampled is all that stays."""
    old.element.children = [child for child in old.element.children if child.name == "sample_count"]


def _sensor(old: Old) -> None:
    """sensors/*: nothing moves here, so that a shutter makes no difference."""
    if old.element.type == "perspective_rdist":
        old.element.attributes["type"] = "perspective"
        old.take("kc")
        old.lose('no support for the distortion "kc" of a lens; taken without')


def _film(old: Old) -> None:
    """films/*: they differ in how an image is written."""
    if old.element.type in ("ldrfilm", "tiledhdrfilm", "mfilm"):
        if old.element.type == "mfilm":
            for side in ("width", "height"):
                if old.find(side) is None:
                    old.add("integer", side, 1)
        old.element.attributes["type"] = "hdrfilm"


def _shape(old: Old) -> None:
    """librender/shape.cpp: a shape with media and no material is not seen. 0.3.0.xsl: v of OBJ files."""
    kinds = {old.kind(child) for child in old.element.children}
    if "medium" in kinds and not kinds & {"bsdf", "emitter", "subsurface"}:
        old.element.children.append(made("bsdf", old.element.place, type="null"))
    if (angle := old.take("max_smooth_angle")) is not None:
        # librender/trimesh.cpp, rebuildTopology: faces that meet at more than this have separate normals.
        if numbers(angle.need("value"), angle.place, 1)[0] > 0:
            old.note("normals of meshes with a maximum angle of smoothing are those of their files")
        else:
            old.set("boolean", "face_normals", "true")
    if old.element.type == "obj" and old.version < (0, 3):
        old.set("boolean", "flip_tex_coords", "false")
    for child in old.element.children:
        if child.tag == "animation":
            _hold(old, child)


def _hold(old: Old, animation: Element) -> None:
    """core/track.cpp: of a motion the first moment."""
    moments = [child for child in animation.children if child.tag == "transform"]
    old.lose("no support for an <animation>; taken as at its first moment")
    animation.tag = "transform"
    animation.children = moments[0].children if moments else []


def _subsurface(old: Old) -> None:
    """subsurface/*: taken as an opaque surface."""
    old.lose(f'no support for the subsurface "{old.element.type}"')


def _envmap(old: Old) -> None:
    """emitters/envmap.cpp."""
    gamma = old.number("gamma", 0.0)
    if gamma not in (0.0, 1.0, -1.0):
        old.note(f"environment maps of gamma {gamma:g} are decoded as their files say")


def _daylight(old: Old) -> None:
    """emitters/sky.cpp, sun.cpp, sunsky.cpp: Mitsuba 3's of the same names have other axes."""
    old.add("string", "parts", old.element.type)
    old.element.attributes["type"] = "daylight"


def _medium(old: Old) -> None:
    """medium/materials.h: coefficients of scattering and absorption, or those of Mitsuba 3."""
    if old.element.type == "heterogeneous":
        if density := old.find("density"):
            density.attributes["name"] = "sigma_t"
        return
    if (preset := old.take("material")) is not None:
        name = preset.need("value")[:40]
        old.lose(f'no table of the medium "{name}"; give sigmaS and sigmaA, or sigmaT and albedo')
    parts = [old.take(name) for name in ("sigma_s", "sigma_a")]
    if parts == [None, None]:
        return
    scattering, absorption = (_three(each) for each in parts)
    place = old.element.place
    total = [s + a for s, a in zip(scattering, absorption, strict=True)]
    share = [s / t if t > 0 else 0.0 for s, t in zip(scattering, total, strict=True)]
    for name, values in (("sigma_t", total), ("albedo", share)):
        old.element.children.append(said("rgb", name, " ".join(map(str, values)), place))


def _three(value: Element | None) -> list[float]:
    if value is None:
        return [0.0] * 3
    found = numbers(value.need("value"), value.place)
    return found * 3 if len(found) == 1 else found


def _grid(old: Old) -> None:
    """volume/gridvolume.cpp: it fills the box that its file says."""
    old.add("boolean", "use_grid_bbox", "true")


def _mixture_of_phases(old: Old) -> None:
    """phase/mixturephase.cpp."""
    weights = numbers(old.text("weights", "").replace(";", " "), old.element.place)
    if len(weights) == 2 and sum(weights) > 0:
        old.element.attributes["type"] = "blendphase"
        old.add("float", "weight", weights[1] / sum(weights))


RULES: dict[tuple[str, str], Callable[[Old], None]] = {
    **LOOKS,
    ("integrator", ""): _integrator,
    ("sampler", ""): _sampler,
    ("sensor", ""): _sensor,
    ("film", ""): _film,
    ("shape", ""): _shape,
    ("subsurface", ""): _subsurface,
    ("emitter", "envmap"): _envmap,
    ("emitter", "sky"): _daylight,
    ("emitter", "sun"): _daylight,
    ("emitter", "sunsky"): _daylight,
    ("medium", ""): _medium,
    ("volume", "gridvolume"): _grid,
    ("phase", "mixturephase"): _mixture_of_phases,
}
"""By tag and type; an empty type is for all."""

IGNORED: dict[tuple[str, str], tuple[str, ...]] = {
    ("sensor", ""): ("shutter_open", "shutter_close"),
    ("film", ""): (
        "attach_log",
        "burn",
        "exposure",
        "filename",
        "fit_horizontal",
        "gamma",
        "key",
        "pixel_aspect_x",
        "pixel_aspect_y",
        "shift_x",
        "shift_y",
        "tonemap_method",
    ),
    ("bsdf", ""): ("ensure_energy_conservation", "sdmm_filename"),
    ("texture", "bitmap"): ("cache", "max_anisotropy"),
    ("emitter", "envmap"): ("cache",),
    ("shape", "sphere"): ("face_normals",),
    ("shape", ""): ("collapse", "load_materials", "srgb"),
    ("medium", ""): (
        "channel",
        "medium_sampling_weight",
        "method",
        "monochromatic",
        "sampling_density",
        "step_size",
        "strategy",
    ),
    ("volume", ""): ("send_data",),
}
"""Parameters that change how an image is computed, written or shown, and not the limit of the image; or that
no plugin of 0.6 reads, which says so and goes on. By tag and type.
`sdmmFilename` is of a fork (sdmm-mitsuba) that samples materials by files of mixtures."""
