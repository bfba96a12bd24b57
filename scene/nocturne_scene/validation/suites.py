"""All suites, in the order in which they are rendered."""

from nocturne_scene.validation import (
    cie171,
    colours,
    configuration_factors,
    enclosures,
    films,
    interfaces,
    lamps,
    media,
    polarisation,
    wavelengths,
)
from nocturne_scene.validation.cases import Suite

SUITES = (
    Suite("cie171", "CIE 171:2006, analytic cases", cie171.scenes),
    Suite("lamps", "Inverse-square law", lamps.scenes),
    Suite("factors", "Configuration factors", configuration_factors.scenes),
    Suite("enclosures", "Integrating spheres, cavities and furnaces", enclosures.scenes),
    Suite("glass", "Fresnel's faces and plates", interfaces.scenes),
    Suite("films", "Thin films and coated panes", films.scenes),
    Suite("media", "Slabs, half spaces and layers of media", media.scenes),
    Suite("polarisation", "Stokes vectors: filters, faces, plates, molecules, air", polarisation.scenes),
    Suite("colours", "Standard illuminants and black bodies", colours.scenes),
    Suite("wavelengths", "Ultraviolet and near infrared: W, photons, weighed watts", wavelengths.scenes),
)
