"""What the grammar leaves out, and why; some of it works since, and is not made yet."""

KNOWN = {
    "half in a medium": "sensors and lamps are wholly inside or outside of bodies of media and glass, and "
    "no boundary moves over them: mended since (decision 0125), and tested in test_photon_starts.py",
    "instances of lamps": "the same lamp stands in one medium only, in all of its instances",
    "far films": "what distant light falls on is within the ball around all surfaces: mended since, and "
    "tested in test_photon_starts.py",
    "planets forwards": "scenes with an atmosphere are not traced from luminaires: of photons that start on "
    "a ball around the planet none gets to a film",
    "where layers end": "no surface lies in a plane where a layered medium without bounds ends: mended "
    "since, and tested in altitude_density_test.cpp",
    "things around an intensity meter": "nothing is outside of its ball: photons from it see what is there, "
    "and photons from luminaires count where they leave the scene at last",
    "lanes in media": 'photons from luminaires do not travel together through media: `"photons_together": 4` '
    'with `"forward"` is refused',
    "air that only scatters": "media without bounds absorb: light wanders in others for ever",
}
