"""How the reference of the scene document is divided into pages, and what its tables say only once."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Subject:
    """A page of the reference."""

    file: str
    title: str
    about: str
    types: tuple[str, ...]
    """In the order of the page: from the whole to its parts."""


@dataclass(frozen=True)
class Union:
    """Several types that may stand in the same place: tables name them by one word."""

    name: str
    file: str
    about: str
    types: tuple[str, ...]
    with_name_or_number: bool = False
    """Whether the word covers a name and a number as well, where both are allowed."""


@dataclass(frozen=True)
class SharedFields:
    """Fields that several types have alike: tables refer to them."""

    name: str
    file: str
    fields: tuple[str, ...]


INDEX = ("SceneDocument", "Wavelengths")
"""Types on the index page."""

SUBJECTS = (
    Subject(
        "shapes",
        "Shapes and placing",
        "What a surface is made of, where it stands, how it moves, and how a group is shown many times.",
        (
            *("Surface", "Instance", "PlacementsFile", "Placement", "Rotation", "RigidMotion", "Turn"),
            *("KeyedMotion", "InlineMesh", "AssetMesh", "Quad", "Sphere", "Disc", "Box", "MediumBox"),
        ),
    ),
    Subject(
        "materials",
        "Materials",
        "Kernels: how surfaces reflect, transmit and absorb light. Pictures show the examples.",
        (
            *("Lambertian", "DiffuseTransmitter", "Conductor", "Dielectric", "ThinPane", "CoatedDiffuse"),
            *("Phong", "Principled", "Measured", "Blend", "Mask", "TwoSided", "NullKernel"),
            *("Fluorophore", "Reradiation"),
        ),
    ),
    Subject(
        "films",
        "Coatings, windows and polarisers",
        "Thin films, panes, and sheets that polarise. How to use them: [films](../how-to/films.md).",
        ("FilmLayer", "Glazing", "SheetPane", "FilmPane", "MeasuredPane", "Polariser", "Retarder"),
    ),
    Subject(
        "spectra",
        "Spectra and indices of refraction",
        "Whatever depends on the wavelength: reflectance, radiance, absorption, indices.",
        (
            *("ConstantSpectrum", "TableSpectrum", "RgbSpectrum", "ChartSpectrum", "BlackbodySpectrum"),
            *("IlluminantSpectrum", "SolarSpectrum", "LineSpectrum", "SpectralLine", "SellmeierIndex"),
            *("SellmeierCoefficients", "CauchyIndex", "TableIndex", "ComplexIndex", "TableExtinction"),
        ),
    ),
    Subject(
        "textures",
        "Textures",
        "Images that vary a colour, a number or the shading normal over a surface.",
        ("Texture", "ColourTexture", "ScalarTexture", "NormalMap", "BumpMap"),
    ),
    Subject(
        "media",
        "Media",
        "Fog, smoke, air, milk, skin. How to use them: [add media](../how-to/media.md).",
        (
            *("Medium", "Interior", "Droplets", "ExponentialDensity", "LayeredDensity", "AbovePlane"),
            *("AboveSphere", "Grid", "IsotropicPhase", "HenyeyGreensteinPhase"),
            *("DoubleHenyeyGreensteinPhase", "RayleighPhase", "TabulatedPhase", "ScatteringMatrix"),
            *("MiePhase", "Dye"),
        ),
    ),
    Subject(
        "lights",
        "Luminaires and skies",
        "What emits light: surfaces, files of luminaires, the sky, the Sun, a planet's air.",
        (
            *("Luminaire", "CosineProfile", "PhotometricProfile", "RayFile", "ConstantEnvironment"),
            *("EnvironmentMap", "StandardSky", "WeatherSky", "Place", "DistantDisc", "Atmosphere"),
            *("AtmosphericAir", "AtmosphericOzone", "AtmosphericAerosol"),
        ),
    ),
    Subject(
        "sensors",
        "Cameras and meters",
        "Cameras show luminance; meters read illuminance and intensity. A scene has one sensor.",
        (
            *("Pinhole", "ThinLens", "Aperture", "Orthographic", "Panorama", "IrradianceMeter"),
            *("RadianceMeter", "IntensityMeter", "Meters", "Instrument", "MeterGrid", "Faces"),
            *("YearOfDaylight", "WeatherFile", "Bands"),
        ),
    ),
    Subject(
        "tracing",
        "Tracing",
        "How photons are traced. In most scenes leave it out: [a pilot chooses](../explanation/method.md).",
        ("Tracing", "Mixture", "ImportantDirection"),
    ),
)

UNIONS = (
    Union(
        "Spectrum",
        "spectra",
        "Wherever a field is a *Spectrum*, write a number, the name of an entry of `$.spectra`, or one of",
        (
            *("ConstantSpectrum", "TableSpectrum", "BlackbodySpectrum", "IlluminantSpectrum"),
            *("SolarSpectrum", "LineSpectrum", "RgbSpectrum", "ChartSpectrum"),
        ),
        with_name_or_number=True,
    ),
    Union(
        "Index",
        "spectra",
        "Wherever a field is an *Index* of refraction, write a number, a name (such as `N-BK7`, `water`; "
        "[the list](../how-to/films.md)), or one of",
        ("SellmeierIndex", "CauchyIndex", "TableIndex"),
        with_name_or_number=True,
    ),
    Union(
        "Kernel",
        "materials",
        "Wherever a field is a *Kernel*, write the name of an entry of `$.kernels`, or one of",
        (
            *("Lambertian", "DiffuseTransmitter", "Conductor", "Dielectric", "ThinPane", "Glazing"),
            *("CoatedDiffuse", "Phong", "Principled", "Measured", "Polariser", "Retarder", "Blend"),
            *("Mask", "TwoSided", "NullKernel"),
        ),
        with_name_or_number=True,
    ),
    Union(
        "Shape",
        "shapes",
        "Wherever a field is a *Shape*, write one of",
        ("InlineMesh", "AssetMesh", "Quad", "Sphere", "Disc", "Box", "MediumBox"),
    ),
    Union(
        "Motion",
        "shapes",
        "Wherever a field is a *Motion*, write one of",
        ("RigidMotion", "KeyedMotion"),
    ),
    Union(
        "Phase function",
        "media",
        "How directions change when light is scattered. Write one of",
        (
            *("IsotropicPhase", "HenyeyGreensteinPhase", "DoubleHenyeyGreensteinPhase", "RayleighPhase"),
            *("TabulatedPhase", "MiePhase"),
        ),
    ),
    Union(
        "Environment",
        "lights",
        "Light from infinitely far away, from all directions. Write one of",
        ("ConstantEnvironment", "EnvironmentMap", "StandardSky", "WeatherSky"),
    ),
    Union(
        "Sensor",
        "sensors",
        "Write one of",
        (
            *("Pinhole", "ThinLens", "Orthographic", "Panorama", "IrradianceMeter", "RadianceMeter"),
            *("IntensityMeter", "Meters"),
        ),
    ),
)

SHARED = (
    SharedFields(
        "Fields of all sensors",
        "sensors",
        (
            *("observer", "responses", "measures", "named_responses", "bands", "colour", "light_parts"),
            *("wavelengths", "motion"),
        ),
    ),
    SharedFields("Fields of all cameras", "sensors", ("stokes", "position", "look_at", "up")),
    SharedFields("Fields of all lights", "lights", ("hidden_from", "light_group")),
    SharedFields("Fields of skies with a Sun", "lights", ("sun", "place", "time", "up")),
    SharedFields(
        "Fields of rough surfaces",
        "materials",
        ("roughness", "roughness_u", "roughness_v", "distribution"),
    ),
    SharedFields("Fields of spectra as light", "spectra", ("luminance",)),
    SharedFields("Fields of a placement", "shapes", ("scale", "rotate", "translate")),
    SharedFields("Fields of all uses of a texture", "textures", ("texture", "scale", "offset")),
)

SHOWN_WITH = {
    "SceneDocument": "",
    "PlacementsFile": "Instance",
    "Placement": "KeyedMotion",
    "Turn": "RigidMotion",
    "FilmPane": "Glazing",
    "SheetPane": "Glazing",
    "SpectralLine": "LineSpectrum",
    "SellmeierCoefficients": "SellmeierIndex",
    "TableExtinction": "ComplexIndex",
    "Texture": "ColourTexture",
    "Interior": "Medium",
    "AbovePlane": "ExponentialDensity",
    "AboveSphere": "LayeredDensity",
    "Place": "StandardSky",
    "AtmosphericAir": "Atmosphere",
    "AtmosphericOzone": "Atmosphere",
    "AtmosphericAerosol": "Atmosphere",
    "Aperture": "ThinLens",
    "Instrument": "Meters",
    "MeterGrid": "Meters",
    "WeatherFile": "YearOfDaylight",
    "Faces": "Meters",
    "Mixture": "Tracing",
}
"""Types that are seen in the example of another."""
