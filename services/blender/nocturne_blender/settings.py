"""Settings of a scene, of a lamp, and of all of Blender."""

import os
from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

DEFAULT_URL = "http://127.0.0.1:7070"

# CIE 15:2018, and names of lamps that people know them by.
_ILLUMINANTS = (
    ("A", "A", "Incandescent lamp, 2856 K"),
    ("D50", "D50", "Daylight, 5000 K"),
    ("D65", "D65", "Daylight, 6500 K"),
    ("E", "E", "Equal energy"),
    ("FL2", "FL2", "Cool white fluorescent"),
    ("FL11", "FL11", "Three bands, 4000 K"),
    ("HP1", "HP1", "High-pressure sodium"),
    ("LED-B1", "LED-B1", "White LED, 2700 K"),
    ("LED-B3", "LED-B3", "White LED, 4100 K"),
    ("LED-B5", "LED-B5", "White LED, 6600 K"),
)


class NocturneScene(bpy.types.PropertyGroup):
    """Of a scene."""

    url: StringProperty(name="Service", description="Address of the Nocturne service", default=DEFAULT_URL)
    start_here: BoolProperty(
        name="Start One Here",
        description="Where no service answers at an address of this machine, start one while Blender runs",
        default=True,
    )
    samples: IntProperty(
        name="Samples", description="Samples per pixel, at most", default=256, min=1, max=2**24
    )
    error: FloatProperty(
        name="Error",
        description="End when the relative error of the image is this small; 0: at the last sample",
        default=0.0,
        min=0.0,
        max=100.0,
        subtype="PERCENTAGE",
    )
    seconds: FloatProperty(
        name="Time", description="End after so many seconds of rendering; 0: no limit", default=0.0, min=0.0
    )
    until: StringProperty(
        name="Until", description='End at a time with its zone, such as "07:00 Europe/Berlin"', default=""
    )


class NocturneLight(bpy.types.PropertyGroup):
    """Of a lamp."""

    unit: EnumProperty(
        name="Power in",
        items=(
            ("WATTS", "Watts", "Blender's own power: W of D65 from 360 to 830 nm"),
            ("LUMENS", "Lumens", "Luminous flux; of a sun, the illuminance in lx"),
        ),
    )
    lumens: FloatProperty(name="Lumens", default=1000.0, min=0.0, description="lm; of a sun, lx")
    spectrum: EnumProperty(
        name="Spectrum",
        items=(
            (
                "COLOUR",
                "Colour",
                "A smooth spectrum of the lamp's colour, or a black body of its temperature",
            ),
            ("ILLUMINANT", "Illuminant", "One of the CIE's"),
        ),
    )
    illuminant: EnumProperty(name="Illuminant", items=_ILLUMINANTS, default="D65")


class NocturnePreferences(bpy.types.AddonPreferences):
    """Of this Blender; kept out of .blend files."""

    bl_idname = __package__

    token: StringProperty(name="Token", description="Where the service asks for one", subtype="PASSWORD")
    program: StringProperty(
        name="Program",
        description="`nocturne`, to start a service on this machine",
        default="nocturne",
        subtype="FILE_PATH",
    )
    data: StringProperty(
        name="Data Folder", description="Of a service that is started here", default="", subtype="DIR_PATH"
    )

    def draw(self, context: Any) -> None:
        """Shows them."""
        del context
        for name in ("token", "program", "data"):
            self.layout.prop(self, name)


def _preferences() -> Any:
    found = bpy.context.preferences.addons.get(__package__)
    return None if found is None else found.preferences


def token() -> str:
    """What the service knows the caller by; empty where nothing is set."""
    found = _preferences()
    return (found.token if found else "") or os.environ.get("NOCTURNE_TOKEN", "")


def program() -> str:
    """The command line `nocturne`."""
    found = _preferences()
    return os.environ.get("NOCTURNE_PROGRAM") or (found.program if found else "nocturne")


def data_folder() -> Path:
    """Of a service that is started here."""
    found = _preferences()
    chosen = os.environ.get("NOCTURNE_DATA") or (found.data if found else "")
    return (
        Path(bpy.path.abspath(chosen)) if chosen else Path(bpy.utils.user_resource("DATAFILES")) / "nocturne"
    )


CLASSES = (NocturneScene, NocturneLight, NocturnePreferences)


def register() -> None:
    """Makes the settings known to Blender."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.nocturne = PointerProperty(type=NocturneScene)
    bpy.types.Light.nocturne = PointerProperty(type=NocturneLight)


def unregister() -> None:
    """Takes them back."""
    del bpy.types.Light.nocturne
    del bpy.types.Scene.nocturne
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
