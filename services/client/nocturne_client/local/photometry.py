"""`nocturne ies`: what an intensity meter saw, as a photometric file of either kind."""

from pathlib import Path

import numpy as np
import OpenImageIO as oiio  # noqa: N813 - the name in its documentation
from nocturne_scene.photometry import eulumdat
from nocturne_scene.photometry import ies as photometric_files
from nocturne_scene.photometry.meter_images import photometry_of
from nocturne_scene.quantities import INTENSITY, quantity_named

from nocturne_client.errors import NocturneClientError


def write_photometry(image: Path, output: Path) -> None:
    """Writes the EXR of an intensity meter as LM-63-2002, or as EULUMDAT where the name ends in .ldt;
    both absolute. Raises NocturneClientError."""
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
    candela, error = (pixels[..., spec.channelnames.index(name)] for name in ("Y", "Y.stderr"))
    # LM-63-2002, 5.2, asks for the first four.
    keywords = {
        "TEST": f"computed, scene {scene}",
        "TESTLAB": f"Nocturne, engine {engine}",
        "ISSUEDATE": "not said",
        "MANUFAC": "not said",
        "OTHER": f"standard errors up to {error.max():.3g} cd",
    }
    try:
        made = photometry_of(candela, keywords)
        as_eulumdat = output.suffix.lower() == ".ldt"
        data = eulumdat.write(made) if as_eulumdat else photometric_files.write(made)
        output.write_bytes(data)
    except ValueError as problem:
        raise NocturneClientError(f"{image}: {problem}") from problem
    except OSError as problem:
        raise NocturneClientError(f"{output}: {problem.strerror}") from problem
