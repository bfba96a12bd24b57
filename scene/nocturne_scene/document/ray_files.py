"""Lamps as the rays of a file, in the scene document."""

from typing import Annotated

from pydantic import Field

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import AssetReference, Finite
from nocturne_scene.document.light_fields import LightGroup
from nocturne_scene.document.placement import Placement
from nocturne_scene.document.spectra import SpectrumReference


class RayFile(Placement):
    """A lamp as the rays of a file: what leaves it, and from where, as it was measured close to it. The lamp
    itself is no surface: its rays start in the air, and nothing of it is seen or met.

    Photons are drawn from the rays in proportion to their flux, and leave exactly along them. Only photons
    from luminaires can do that, so the sensor is an `irradiance_meter` or an `intensity_meter`. The file's z,
    which mostly is where the lamp points to, is the scene's unless `rotate` turns it.
    """

    asset: AssetReference = Field(
        description="A ray file of IES TM-25 (.tm25ray): a path relative to the document, or `sha256:` and "
        "its digest."
    )
    radiance: SpectrumReference | None = Field(
        default=None,
        description="Spectrum of the light, of any size. Default: that of all rays of the file together, "
        "whatever their directions.",
    )
    lumens: Annotated[Finite, Field(gt=0, le=bounds.LUMINANCE)] | None = Field(
        default=None, description="Luminous flux of all rays, lm. Default: what the file says."
    )
    dimming: Annotated[Finite, Field(gt=0, le=1)] = Field(
        default=1.0, description="To which part of its full light the lamp is dimmed."
    )
    light_group: LightGroup = ""
