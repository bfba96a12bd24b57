"""What the grammar leaves out, and why."""

KNOWN = {
    "half in a medium": "sensors and lamps are wholly inside or outside of bodies of media and glass, and "
    "no boundary moves over them: the tracer takes what is around their centre when the shutter opens for "
    "all of them",
    "instances of lamps": "the same lamp stands in one medium only, in all of its instances",
    "far films": "what distant light falls on is within the ball around all surfaces: photons of the Sun and "
    "of the sky start on that ball",
    "planets forwards": "scenes with an atmosphere are not traced from luminaires: of photons that start on "
    "a ball around the planet none gets to a film",
    "where layers end": "no surface lies in a plane where a layered medium without bounds ends: photons are "
    "stuck there until a million interactions end them",
    "things around an intensity meter": "nothing is outside of its ball: photons from it see what is there, "
    "and photons from luminaires count where they leave the scene at last",
    "lanes in media": 'photons from luminaires do not travel together through media: `"photons_together": 4` '
    'with `"forward"` is refused by the tracer, not by the compiler',
    "air that only scatters": "media without bounds absorb: light wanders in others for ever",
}
