"""Bounds of a scene document beyond those of the service (`nocturne_coordinator.limits`), each with its
reason.
"""

# Metres. Products of three lengths stay finite in float32 (1e36 < 3.4e38), and no scene needs more.
LENGTH = 1e12

# Metres. Squares of lengths stay above the smallest normal float32 (1.2e-38).
MIN_LENGTH = 1e-18

# Square metres: twice a triangle's area, times a ray's cosine. Embree takes hits below it for a corner (its
# min_rcp_input), which is why smaller triangles count as having no area.
EMBREE_AREA = 1e-18

# Metres across a shape. At this size hits suffer from EMBREE_AREA only where the cosine is below 1e-4: one
# in 1e8 of diffuse light. Below the wavelength of light rays mean nothing anyway.
MIN_SIZE = 1e-7

# W m-2 sr-1 nm-1. Twenty bounces' worth of weights stay finite in float32; the sun's surface is about 3e4.
RADIANCE = 1e20

# cd/m2: RADIANCE in the unit of luminance, rounded.
LUMINANCE = 1e20

# Kelvin. Above a million the visible spectrum only scales.
TEMPERATURE = 1e6

# Nanometres of a table's knots: what a tabulated optical spectrum may cover.
MIN_WAVELENGTH = 1.0
MAX_WAVELENGTH = 100_000.0

# Knots of one table: ten per nanometre of the visible range, rounded up.
TABLE_KNOTS = 10_000
# Of a wave plate: a hundred orders.
RETARDANCE_NM = 1e5

# Of a re-radiation matrix, in each direction, and fluorophores of a surface.
RERADIATION_KNOTS = 200
FLUOROPHORES = 4

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

# --- kernels ---

# Kernels inside kernels, names followed: deeper ones are a mistake, or made by a program.
KERNEL_DEPTH = 8

# Parts of a flattened blend, as the tracer takes it.
BLEND_PARTS = 8

# Layers of a film, as the tracer takes them; and their thickness: above it no light is that coherent.
FILM_LAYERS = 64
FILM_THICKNESS_NM = 1e5

# Of refraction of a film's layers: together with the thickness the phase of a wave in them stays below 1e6.
FILM_INDEX = 100.0

# Panes of a glazing.
PANES = 8

# Of a Phong lobe: a half width of 0.07 degrees.
PHONG_EXPONENT = 1e6

# Priorities of interiors: 32-bit numbers in the compiled scene, of which far fewer are needed.
PRIORITY = 1_000_000

# Lines of one spectrum: the iron arc has fewer in the visible range.
SPECTRAL_LINES = 1000

# --- what varies ---

# Entries of $.textures.
TEXTURES = 10_000

# Repeats of a texture over a surface's coordinates, and shifts of it.
TEXTURE_SCALE = 1e6

# Time steps of anything that moves, ends included: Embree's limit.
TIME_STEPS = 129

# Moving along an arc in straight pieces: the farthest from the arc, as a part of the distance to the axis.
# 1/3000 lets 128 pieces make one full turn.
ARC_DEVIATION = 1 / 3000

# --- geometry ---

# Corners of a disc's edge. At 65536 its area is right to float32's last digit.
DISC_SEGMENTS = 65_536

# Entries of $.groups, of one group, and of $.instances.
GROUPS = 10_000
INSTANCES = 1_000_000

# Instances once groups in groups are flattened: 100 bytes each in the compiled scene, some 500 in Embree.
FLATTENED_INSTANCES = 1_000_000

# --- the rest ---

# Discs at infinity, important shapes: each is looked at from every vertex.
DISTANT_DISCS = 100
RAY_FILES = 100
IMPORTANT_SHAPES = 100

# Channels beyond X, Y, Z: each takes memory for every pixel.
RESPONSES = 64

# Points of a sensor's meters, and its instruments: the image's header has all of them.
METERS = 4096
INSTRUMENTS = 64

# Edges of a lens opening.
APERTURE_BLADES = 64

# Vertices at which a path splits: each doubles or trebles the work.
SPLIT_VERTICES = 8

# Degrees. Directions in float32 are 3e-6 degrees apart; the smallest disc in the sky is thousands of them.
MIN_ANGLE = 0.01

# Groups inside groups; each level multiplies, so more than a few are a mistake.
GROUP_DEPTH = 32

# --- media ---

# Media that fill one body: each is asked for its nearest hit.
MEDIA_IN_BODY = 32

# Entries of $.media.
MEDIA = 1000

# 1/m, where the density is 1.
COEFFICIENT = 1e20

# Factor of a medium's coefficients: a molecule's cross-section is 1e-31 m2, and there are 1e25 in a cubic
# metre.
MEDIUM_DENSITY = 1e30

# Droplets in a cubic metre: molecules of air are fewer.
DROPLETS = 1e26

# Exponents of a distribution of droplets: beyond, all have one size.
DROPLET_SHAPE = 100.0

# Cosines of a tabulated phase function, and all of its values: as the tracer takes them.
PHASE_COSINES = 100_000
PHASE_VALUES = 10_000_000
