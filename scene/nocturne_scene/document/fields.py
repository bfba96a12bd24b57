"""Types of single fields of the scene document.

Numbers that are numbers, names, vectors, asset references.
"""

from typing import Annotated, Literal, get_args

from pydantic import Field, StrictBool, StringConstraints

from nocturne_scene.document import bounds

# Numbers: JSON numbers only (no text, no true/false), never NaN or infinite.
Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Fraction = Annotated[Finite, Field(ge=0, le=1)]
NotNegative = Annotated[Finite, Field(ge=0)]
Coordinate = Annotated[Finite, Field(ge=-bounds.LENGTH, le=bounds.LENGTH)]
PositiveLength = Annotated[Finite, Field(ge=bounds.MIN_LENGTH, le=bounds.LENGTH)]
Wavelength = Annotated[Finite, Field(ge=bounds.MIN_WAVELENGTH, le=bounds.MAX_WAVELENGTH)]
SpectralValue = Annotated[Finite, Field(ge=0, le=bounds.RADIANCE)]
VertexIndex = Annotated[int, Field(strict=True, ge=0, lt=2**32)]

Switch = StrictBool
Vector = tuple[Coordinate, Coordinate, Coordinate]
# Degrees of an angle of any number of turns, within reason.
Degrees = Annotated[Finite, Field(ge=-36_000, le=36_000)]
Triangle = tuple[VertexIndex, VertexIndex, VertexIndex]
Knot = tuple[Wavelength, SpectralValue]

# Names are keys in error messages, so they hold no quotes, slashes or control characters.
Name = Annotated[
    str,
    StringConstraints(strict=True, max_length=bounds.NAME_LENGTH, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_. -]*$"),
]
Text = Annotated[str, StringConstraints(strict=True, max_length=bounds.TEXT_LENGTH)]
AssetReference = Annotated[
    str,
    StringConstraints(strict=True, min_length=1, max_length=bounds.PATH_LENGTH, pattern=r"^[^\x00-\x1f]+$"),
]
MeshFormat = Literal["obj", "ply", "stl", "gltf", "glb"]

MESH_FORMATS: dict[str, MeshFormat] = {known: known for known in get_args(MeshFormat)}
