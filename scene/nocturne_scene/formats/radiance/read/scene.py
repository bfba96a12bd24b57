"""A whole scene of Radiance: its primitives in order, and the modifiers that they name."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from nocturne_scene.errors import InputError
from nocturne_scene.formats.radiance.read import materials, skies, surfaces
from nocturne_scene.formats.radiance.read.primitives import Primitive, primitives
from nocturne_scene.formats.reading.extent import Extent
from nocturne_scene.formats.reading.findings import Findings
from nocturne_scene.formats.reading.options import ImportOptions
from nocturne_scene.formats.reading.scene_files import TEXT_BYTES
from nocturne_scene.formats.reading.scene_writer import Json, SceneWriter
from nocturne_scene.formats.reading.views import panorama_inside
from nocturne_scene.meshes.triangles import Triangles, merge
from nocturne_scene.texts import text_of

_SUN_DEGREES = 10.0
"""A source that is larger is a part of the sky."""
_MATERIALS = (*materials.EMITTING, "plastic", "metal", "mirror", "trans", "glass", "dielectric")
_ROUND = ("sphere", "bubble")


@dataclass
class _Reader:
    writer: SceneWriter
    findings: Findings
    modifiers: dict[str, Primitive] = field(default_factory=dict)
    """Materials and patterns by name; the last one of a name counts, as in Radiance."""
    meshes: dict[str, list[Triangles]] = field(default_factory=dict)
    """By material."""
    kernels: dict[str, str] = field(default_factory=dict)
    skies: list[tuple[Primitive, Primitive, Primitive | None]] = field(default_factory=list)
    extent: Extent = field(default_factory=Extent)

    def read(self, given: Primitive) -> None:
        """Raises InputError for a wrong primitive, or a kind that is not read."""
        if given.kind == "alias":
            self.modifiers[given.name] = self._known(given.texts[0], given)
        elif given.kind in (*_MATERIALS, "brightfunc"):
            self.modifiers[given.name] = given
        elif given.kind == "source":
            self._source(given)
        elif given.kind in _ROUND:
            self._sphere(given)
        elif given.kind in surfaces.MESHES:
            mesh = surfaces.MESHES[given.kind](given)
            self.extent.add(mesh.vertices)
            self._material(given)
            self.meshes.setdefault(given.modifier, []).append(mesh)
        else:
            # Surfaces of that modifier have no material then, and are lost, too.
            known = ", ".join((*_MATERIALS, *surfaces.MESHES, *_ROUND, "source", "alias"))
            raise InputError.at(given.place, f"{given.kind} {given.name} is not read; read are {known}")

    def _known(self, name: str, by: Primitive) -> Primitive:
        found = self.modifiers.get(name)
        if found is None:
            raise InputError.at(
                by.place, f"{by.kind} {by.name}: no material {name} that is read stands before it"
            )
        return found

    def _material(self, surface: Primitive) -> tuple[Json, Json]:
        """Kernel and luminaire; the kernel is written once."""
        material = self._known(surface.modifier, surface)
        if material.modifier != "void" and material.modifier in self.modifiers:
            said = f"{material.kind} {material.name}: the pattern {material.modifier} is left out"
            self.findings.lost(material.place, said)
        elif material.modifier != "void":
            said = f"{material.kind} {material.name}: its modifier {material.modifier} is left out"
            self.findings.lost(material.place, said)
        if material.kind in materials.EMITTING:
            return materials.BLACK, {"radiance": materials.emission(material, self.findings)}
        if surface.modifier not in self.kernels:
            made = materials.kernel(material, self.findings)
            self.kernels[surface.modifier] = self.writer.name("kernels", surface.modifier, made)
        return self.kernels[surface.modifier], None

    def _sphere(self, given: Primitive) -> None:
        x, y, z, radius = given.need(4)
        if given.kind == "bubble":
            raise InputError.at(given.place, f"bubble {given.name} is not read; a sphere is")
        if not radius > 0.0:
            raise InputError.at(
                given.place, f"sphere {given.name}: expected a radius above 0, found {radius:g}"
            )
        kernel, luminaire = self._material(given)
        centre = surfaces.turned(np.array([x, y, z]))
        self.extent.add(np.stack([centre - radius, centre + radius]))
        shape = {"type": "sphere", "centre": centre.tolist(), "radius": radius}
        self._add(given.name, shape, kernel, luminaire)

    def _add(self, name: str, shape: Json, kernel: Json, luminaire: Json) -> None:
        lit = {} if luminaire is None else {"luminaire": luminaire}
        self.writer.add("surfaces", {"name": name[:60], "shape": shape, "kernel": kernel, **lit})

    def _source(self, given: Primitive) -> None:
        x, y, z, angle = given.need(4)
        glow = self._known(given.modifier, given)
        if glow.kind not in materials.EMITTING or not np.linalg.norm([x, y, z]) > 0.0:
            raise InputError.at(given.place, f"source {given.name}: expected a direction, and light or glow")
        function = self.modifiers.get(glow.modifier)
        if glow.modifier != "void" and function is None:
            raise InputError.at(glow.place, f"{glow.kind} {glow.name}: {glow.modifier} is not read")
        if function is not None:
            skies.brightness(function, np.array([0.0, 0.0, 1.0]))
        if angle < _SUN_DEGREES and function is None:
            if not any(glow.numbers[:3]):
                # gendaylit writes a Sun for skies without one, too.
                return
            towards = surfaces.turned(np.array([x, y, z])).tolist()
            disc = {"direction": towards, "angular_diameter_degrees": angle}
            radiance = materials.emission(glow, self.findings)
            self.writer.add("distant", disc | {"radiance": radiance})
        else:
            self.skies.append((given, glow, function))

    def finish(self) -> None:
        """Writes a mesh for each material, and the sky."""
        for modifier, parts in self.meshes.items():
            material = self.modifiers[modifier]
            shape = self.writer.mesh(modifier, merge(parts))
            if material.kind in materials.EMITTING:
                lamp = {"radiance": materials.emission(material, self.findings)}
                self._add(modifier, shape, materials.BLACK, lamp)
            else:
                self._add(modifier, shape, self.kernels[modifier], None)
        if self.skies:
            pixels = skies.picture(self.skies)
            asset = self.writer.picture("sky", pixels)
            self.writer.document["environment"] = {"asset": asset, "luminance": 1.0}
            self.findings.note("", "Radiance's sky became a picture; its blend at the horizon is in it")
        self.writer.document["sensor"] = panorama_inside(self.extent, self.findings)


def import_radiance(file: Path, writer: SceneWriter, findings: Findings, options: ImportOptions) -> None:
    """Writes the scene of a `.rad` file. Raises InputError."""
    del options
    if file.stat().st_size > TEXT_BYTES:
        raise InputError.at(file.name, f"is larger than {TEXT_BYTES:,} bytes")
    with file.open("rb") as binary, text_of(binary) as lines:
        text = lines.read()
    reader = _Reader(writer, findings)
    for given in primitives(text, file.name, findings):
        with findings.leaving_out():
            reader.read(given)
    reader.finish()
    findings.note("", "lengths are taken as metres; z, up there, became y, and north became -z")
    findings.note("", "Radiance's white became D65, and 179 lm/W, so that luminances are the same")
