"""Stokes vectors of random layers of air by sasktran2, in a separate environment:

    python -m venv E; E/bin/pip install sasktran2; E/bin/python bench/peer/layers_of_air.py

Prints the rows that `scene/nocturne_scene/validation/polarisation.json` has as `layers`, with I, Q and U for
an irradiance of 1, and last by how much of I these change between 40 and 64 streams (2e-5 at most). For a
layer of optical depth 0.5 above a black ground it gives the corrected Coulson tables to 8 digits.
"""

import json
from typing import Any

import numpy as np
import sasktran2 as sk

_COUNT, _SEED, _DEPTH_M = 50, 20261201, 1000.0


def stokes(layer: list[float], streams: int) -> Any:
    """Of the light that leaves upwards. `layer`: optical depth, albedo of scattering, depolarisation,
    reflectance of the ground, cosine of the Sun's zenith angle, of the view's, azimuth from where light goes,
    degrees."""
    depth, albedo, depolarisation, ground, mu0, mu, azimuth = layer
    config = sk.Config()
    config.num_stokes = 3
    config.num_streams = config.num_singlescatter_moments = streams
    config.multiple_scatter_source = sk.MultipleScatterSource.DiscreteOrdinates
    config.single_scatter_source = sk.SingleScatterSource.DiscreteOrdinates
    heights = np.array([0.0, 0.5, 1.0]) * _DEPTH_M
    kinds = sk.InterpolationMethod.LinearInterpolation, sk.GeometryType.PlaneParallel
    geometry = sk.Geometry1D(mu0, 0.0, 6.371e6, heights, *kinds)
    viewing = sk.ViewingGeometry()
    viewing.add_ray(sk.GroundViewingSolar(mu0, np.radians(azimuth), mu, 2e5))
    air = sk.Atmosphere(geometry, config, numwavel=1, calculate_derivatives=False)
    air.storage.total_extinction[:] = depth / _DEPTH_M
    air.storage.ssa[:] = albedo
    # Of Rayleigh's matrix: J. E. Hansen and L. D. Travis, Space Science Reviews 16, 1974.
    share = (1 - depolarisation) / (2 + depolarisation)
    moments = air.leg_coeff
    moments.a1[0], moments.a1[2], moments.a2[2], moments.b1[2] = 1, share, 6 * share, 6**0.5 * share
    air.surface.albedo[:] = ground
    return np.asarray(sk.Engine(config, geometry, viewing).calculate_radiance(air)["radiance"])[0, 0]


def main() -> None:
    """Prints them."""
    random, change = np.random.default_rng(_SEED), 0.0
    for number in range(_COUNT):
        depth = round(float(np.exp(random.uniform(np.log(0.05), np.log(1.5)))), 3)
        albedo = 1.0 if number % 2 else round(float(random.uniform(0.6, 1)), 3)
        depolarisation = round(float(random.uniform(0, 0.1)), 3)
        ground = 0.0 if number % 3 == 0 else round(float(random.uniform(0, 0.8)), 2)
        mu0, mu = (round(float(random.uniform(0.15, 1)), 3) for _ in "ab")
        layer = [depth, albedo, depolarisation, ground, mu0, mu, round(float(random.uniform(0, 360)), 1)]
        found = stokes(layer, 64)
        change = max(change, float(np.abs(found - stokes(layer, 40)).max() / found[0]))
        print(json.dumps([*layer, *(float(f"{each:.7g}") for each in found)]))
    print(f"{change:.2g}")


if __name__ == "__main__":
    main()
