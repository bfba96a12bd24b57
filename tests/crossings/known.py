"""What the grammar leaves out, and why: mostly what the compiler refuses with its place."""

KNOWN = {
    "planets forwards": "with an atmosphere nothing is traced from luminaires: photons of the Sun would "
    "start on a ball around the planet, in steps of half a metre, and next to none would get to the scene",
    "glow forwards": "meters beside media that glow are traced from the meter: no photon starts in a medium",
    "tilted normals forwards": "meters beside surfaces with normal maps or bump maps are traced from the "
    "meter: a photon from a luminaire does not know from where such a normal is looked at",
    "beside an intensity meter": "what is outside of its ball is met by photons from the meter; those from "
    "luminaires count where they leave the scene at last, so they are no second method there",
    "lamps of one surface": "lamps in groups have no flux and no photometric file, which are of one surface",
    "lanes in media": 'photons from luminaires travel alone through media: `"photons_together": 4` with '
    '"forward" is for scenes without',
    "air that only scatters": "media without bounds and without an end absorb: light wanders in others for "
    "ever",
}
