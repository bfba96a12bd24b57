"""`nocturne ies`: what an intensity meter saw, as a photometric file."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene.bands import is_band
from nocturne_scene.photometry import eulumdat, ies, tm33
from nocturne_scene.photometry.intensities import Photometry, Spectrum
from nocturne_scene.photometry.meter_images import photometry_of, spectrum_of
from nocturne_scene.quantities import INTENSITY, quantity_named
from nocturne_scene.spectra.published import Floats

from nocturne_client.errors import NocturneClientError

WRITERS: Mapping[str, Callable[[Photometry], bytes]] = {
    ".ies": ies.write,
    ".ldt": eulumdat.write,
    ".xml": tm33.write,
}
"""LM-63-2002, EULUMDAT and TM-33 by how names end."""


@dataclass(frozen=True, eq=False)
class MeterImage:
    """Of an intensity meter."""

    candela: Floats
    """Shape (height, width), as all others."""
    error: Floats
    """Standard errors, cd."""
    bands: Mapping[str, Floats]
    """By their names, W/sr nm."""
    keywords: Mapping[str, str]
    """Those that LM-63-2002, 5.2, asks for, and one more."""
    spectrum: Spectrum | None = None
    """Where no band tells it."""

    def photometry(self) -> Photometry:
        """Raises ValueError where a file can't hold as many angles."""
        return photometry_of(self.candela, self.keywords, spectrum_of(self.bands) or self.spectrum)


def read_meter_image(image: Path) -> MeterImage:
    """Reads an EXR. Raises NocturneClientError for an image of another sensor than an intensity meter."""
    buffer = oiio.ImageBuf(str(image))
    spec = buffer.spec()
    scene, engine = (spec.getattribute(f"nocturne:{name}") for name in ("scene", "engine"))
    if buffer.has_error or scene is None or "Y" not in spec.channelnames:
        raise NocturneClientError(f"{image} is no EXR of ours: expected an image of an intensity meter")
    quantity = quantity_named(spec.getattribute("nocturne:quantity") or "")
    if quantity is not INTENSITY:
        is_of = f"{quantity.name} in {quantity.unit}" if quantity.name else "an older program, without units"
        raise NocturneClientError(
            f"{image} is of {is_of}; a photometric file is made of an intensity_meter's image, in cd"
        )
    pixels = np.asarray(buffer.get_pixels(oiio.FLOAT), dtype=np.float64)
    channels = {name: pixels[..., index] for index, name in enumerate(spec.channelnames)}
    keywords = {
        "TEST": f"computed, scene {scene}",
        "TESTLAB": f"Nocturne, engine {engine}",
        "ISSUEDATE": "not said",
        "MANUFAC": "not said",
        "OTHER": f"standard errors up to {channels['Y.stderr'].max():.3g} cd",
    }
    bands = {name: values for name, values in channels.items() if is_band(name)}
    return MeterImage(channels["Y"], channels["Y.stderr"], bands, keywords)


def write_photometry(image: Path, output: Path) -> None:
    """Writes the EXR of an intensity meter as LM-63-2002, as EULUMDAT where the name ends in .ldt, or as
    TM-33, with a spectrum where the image has bands, where it ends in .xml; all absolute. Raises
    NocturneClientError."""
    found = read_meter_image(image)
    try:
        write = WRITERS.get(output.suffix.lower(), ies.write)
        output.write_bytes(write(found.photometry()))
    except ValueError as problem:
        raise NocturneClientError(f"{image}: {problem}") from problem
    except OSError as problem:
        raise NocturneClientError(f"{output}: {problem.strerror}") from problem
