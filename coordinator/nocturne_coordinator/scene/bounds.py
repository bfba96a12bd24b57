"""Bounds of a scene document beyond those of the service (`nocturne_coordinator.limits`), each with its
reason.
"""

# Metres. Products of three lengths stay finite in float32 (1e36 < 3.4e38), and no scene needs more.
LENGTH = 1e12

# Metres. Squares of lengths stay above the smallest normal float32 (1.2e-38).
SMALLEST_LENGTH = 1e-18

# W m-2 sr-1 nm-1. Twenty bounces' worth of weights stay finite in float32; the sun's surface is about 3e4.
RADIANCE = 1e20

# cd/m2: RADIANCE in the unit of luminance, rounded.
LUMINANCE = 1e20

# Kelvin. Above a million the visible spectrum only scales.
TEMPERATURE = 1e6

# Nanometres of a table's knots: what a tabulated optical spectrum may cover.
SHORTEST_WAVELENGTH = 1.0
LONGEST_WAVELENGTH = 100_000.0

# Knots of one table: ten per nanometre of the visible range, rounded up.
TABLE_KNOTS = 10_000

# Entries of $.spectra and of $.kernels: far above hand-made scenes, low enough that an error can list them.
NAMED_ENTRIES = 10_000

# Surfaces: each is a message and an Embree geometry; more small parts belong in one mesh.
SURFACES = 100_000

# Interactions of one photon: bounds the work of a single sample.
DEPTH = 100_000

# Characters of a name, of a path, and of free text.
NAME_LENGTH = 200
PATH_LENGTH = 4096
TEXT_LENGTH = 20_000

# Problems told at once; the rest is usually the same mistake again.
PROBLEMS = 50

# Names listed after "expected one of".
CHOICES_SHOWN = 20
