"""All cases, in the order of the page."""

from tests.stability.case import Case
from tests.stability.cases import bodies, inputs, lights, media, meshes, motion, places, spectra, surfaces

GROUPS: dict[str, list[Case]] = {
    "Places and sizes": places.CASES,
    "Meshes and instances": meshes.CASES,
    "Surfaces": surfaces.CASES,
    "Transparent bodies": bodies.CASES,
    "Lights and sensors": lights.CASES,
    "Spectra": spectra.CASES,
    "Media": media.CASES,
    "Motion": motion.CASES,
    "Input": inputs.CASES,
}
