"""The scene compiler.

A checked document in, the tracer's message and its blobs out, addressed by content; parts in compile/.
"""

from collections.abc import Iterator, Sequence
from itertools import islice

from nocturne.v1 import scene_pb2

from nocturne_scene.blobs import BlobStore
from nocturne_scene.compile.atmosphere import atmosphere_surfaces
from nocturne_scene.compile.daylight_coefficients import DaylightStudy
from nocturne_scene.compile.environment import has_sky
from nocturne_scene.compile.faces import with_faces_found
from nocturne_scene.compile.fluorescence import fluoresces
from nocturne_scene.compile.grids import Grids
from nocturne_scene.compile.instances import Instances
from nocturne_scene.compile.kernels import Kernels
from nocturne_scene.compile.lamp_alone import check_lamp_alone
from nocturne_scene.compile.layers import check_can_make, make_layers
from nocturne_scene.compile.lights import Lights
from nocturne_scene.compile.media import Media
from nocturne_scene.compile.origin import frame_of
from nocturne_scene.compile.output import CompiledOutput, blobs_named_in
from nocturne_scene.compile.polarisation import depolarising, is_polarised
from nocturne_scene.compile.ray_files import compile_ray_files
from nocturne_scene.compile.sensors import compile_sensor
from nocturne_scene.compile.shapes import Shapes
from nocturne_scene.compile.surfaces import Surfaces
from nocturne_scene.compile.textures import Textures
from nocturne_scene.compile.tracing import compile_tracing
from nocturne_scene.compile.unseen import met_surfaces
from nocturne_scene.compile.warnings import warnings_of
from nocturne_scene.compile.wavelengths import put_wavelength_density
from nocturne_scene.compile.ways import choose, given_ways, open_ways
from nocturne_scene.compile.workspace import Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.checks import MET_BY_PHOTONS
from nocturne_scene.document.model import SceneDocument
from nocturne_scene.document.problems import path
from nocturne_scene.document.sensors import Meters
from nocturne_scene.document.surfaces import Surface
from nocturne_scene.errors import InputError, NotFound, Problem
from nocturne_scene.film import Film
from nocturne_scene.render_warnings import RenderWarning, from_messages, of_scene

# Layouts of CompiledScene; raised with every change that an older worker would misread. The second one is
# that of scenes whose sensor tells parts of the light, the third of those with a forward_ratio, the
# fourth of those whose photons are guided, the fifth of those with other wavelengths than 360 to 830 nm, the
# sixth of those whose photons know the visible sky, the seventh of those whose responses separate light
# groups, or that have rays of files, the eighth of those whose responses measure polarisation, the ninth of
# those with daylight coefficients.
(
    FORMAT,
    FORMAT_WITH_PARTS,
    FORMAT_WITH_RATIO,
    FORMAT_WITH_GUIDE,
    FORMAT_WITH_RANGE,
    FORMAT_WITH_SKY,
    FORMAT_WITH_LIGHT_GROUPS,
    FORMAT_WITH_STOKES,
    FORMAT_WITH_DAYLIGHT,
) = range(3, 12)


def compile_scene(document: SceneDocument, blobs: BlobStore, film: Film | None = None) -> CompiledOutput:
    """Compile a document and put the scene and its blobs (meshes, textures, tables) into the blob store.

    `film`, where it is known, is for warnings and for choosing how to trace what the document leaves open;
    the choice takes a small part of the time of the render.

    Equal documents and films give equal bytes. Raises InputError with at most `bounds.PROBLEMS` problems, and
    then leaves nothing behind: blobs are written last, when all of them are there.
    """
    study = _daylight(document, blobs)
    if study is not None:
        document, film = study.document, film and study.film(film)
    workspace = Workspace(document, blobs)
    message, scatters = _compile(workspace, film)
    # After the blobs, which a pilot reads.
    _put_tracing(workspace, message, film, scatters=scatters)
    if study is not None:
        study.finish(message)
        message.format = FORMAT_WITH_DAYLIGHT
    scene_sha256 = blobs.put(message.SerializeToString(deterministic=True))
    warnings = [*of_scene(workspace.warnings), *from_messages(message.tracing.warnings)]
    files = scene_sha256, *sorted(set(blobs_named_in(message)))
    return CompiledOutput(scene_sha256, workspace.dropped, warnings, message.tracing.way, files)


def _daylight(document: SceneDocument, blobs: BlobStore) -> DaylightStudy | None:
    sensor = document.sensor
    if not isinstance(sensor, Meters) or sensor.daylight is None:
        return None
    try:
        return DaylightStudy(document, sensor.daylight, blobs)
    except NotFound as error:
        raise InputError.at("$.sensor.daylight.weather.asset", str(error)) from None


def compile_layers(document: SceneDocument, blobs: BlobStore, film: Film, layers: Sequence[str]) -> str:
    """Makes a file of what each pixel of a film sees first, see `nocturne_scene.layers`; its SHA-256.

    Apart from `compile_scene`, as a render can begin without it. Raises InputError.
    """
    check_can_make(layers)
    workspace = Workspace(document, blobs)
    message, scatters = _compile(workspace, film)
    # Surfaces are seen alike by every method of finding light.
    message.tracing.CopyFrom(compile_tracing(workspace, message, given_ways(document), scatters=scatters))
    return make_layers(workspace, message, film, layers)


def _compile(workspace: Workspace, film: Film | None) -> tuple[scene_pb2.CompiledScene, bool]:
    """All but how it is traced, its blobs written, and whether anything sends light on."""
    try:
        message, scatters = _message(workspace, film)
        workspace.write_blobs()
    finally:
        workspace.clean_up()
    return message, scatters


def _message(workspace: Workspace, film: Film | None) -> tuple[scene_pb2.CompiledScene, bool]:
    tells_parts = workspace.document.sensor.light_parts
    message = scene_pb2.CompiledScene(format=FORMAT_WITH_PARTS if tells_parts else FORMAT)
    textures, grids, instances = Textures(workspace), Grids(workspace), Instances(workspace)
    shapes, media = Shapes(workspace, grids), Media(workspace, grids)
    with workspace.problems_at("$.sensor"):
        with_faces_found(workspace, shapes)
    workspace.frame = frame_of(workspace, shapes)
    kernels, lights = Kernels(workspace, textures), Lights(workspace, textures, shapes)
    with workspace.problems_at("$.sensor"):
        message.sensor.CopyFrom(compile_sensor(workspace, film))
    surfaces = Surfaces(workspace, textures, shapes, kernels, media)
    for index, (surface, group, place) in enumerate(_all_surfaces(workspace, instances)):
        message.surfaces.append(surfaces.compile(surface, group, place))
        workspace.objects.append(surface.name or place)
        luminaire = lights.luminaire(surface, index, place)
        if luminaire is not None:
            message.luminaires.append(luminaire)
        if workspace.has_too_many_problems:
            break
    message.surfaces.extend(atmosphere_surfaces(workspace, media))
    message.unbounded_interiors.extend(media.unbounded())
    message.media.extend(media.messages)
    message.instances.extend(instances.flattened())
    environment = lights.environment()
    if environment is not None:
        message.environment.CopyFrom(environment)
    message.distant_discs.extend(lights.distant_discs())
    message.important_shapes.extend(lights.important_shapes())
    message.ray_sets.extend(compile_ray_files(workspace))
    _check_light(workspace, message)
    check_lamp_alone(workspace, shapes, message)
    _refuse_photons_of_luminaires(workspace, message)
    tracing = workspace.document.tracing
    if workspace.document.ray_files and not workspace.photons_can_start:
        told = "only photons from luminaires bring this light, and not all light of this scene can start so"
        workspace.problems.append(Problem("$.ray_files", told))
    forward = tracing.direction == "forward" or workspace.document.ray_files
    if message.media and forward and tracing.photons_together == 4:
        # A meter's count must not depend on where photons part behind it.
        told = "photons from luminaires travel alone through media; expected 1, or auto"
        workspace.problems.append(Problem("$.tracing.photons_together", told))
    if workspace.problems:
        raise InputError(islice(workspace.problems, bounds.PROBLEMS))
    put_wavelength_density(workspace, message)
    message.spectra.extend(workspace.spectra.messages)
    message.kernels.extend(workspace.kernels.messages)
    message.interiors.extend(workspace.interiors.messages)
    message.textures.extend(workspace.textures.messages)
    if textures.rgb_table is not None:
        message.rgb_table.CopyFrom(textures.rgb_table)
    workspace.report_unused()
    workspace.warnings.extend(warnings_of(workspace, shapes, film))
    workspace.warnings.extend(depolarising(message, workspace.kernels.messages))
    # Photons leave a film in directions that are chosen, too.
    from_film = workspace.document.sensor.type in ("irradiance_meter", "meters")
    return message, from_film or kernels.scatters() or media.scatters()


def _put_tracing(
    workspace: Workspace, message: scene_pb2.CompiledScene, film: Film | None, *, scatters: bool
) -> None:
    ways, said, warnings = given_ways(workspace.document), "", list[RenderWarning]()
    if film is not None:
        start = workspace.photons_can_start
        left_open = open_ways(workspace.document, message, film, photons_can_start=start)
        if left_open.names:
            before = len(workspace.dropped)
            message.tracing.CopyFrom(compile_tracing(workspace, message, left_open.asked, scatters=scatters))
            del workspace.dropped[before:]
            ways, said, warnings = choose(message, workspace.blobs.root, film, left_open)
            message.important_shapes.extend(ways.aims)
            message.learned_light = ways.learned_light
            message.visible_sky = ways.visible_sky
    message.tracing.CopyFrom(compile_tracing(workspace, message, ways, scatters=scatters))
    message.tracing.way = said
    message.tracing.warnings.extend(each.message() for each in warnings)
    if message.tracing.forward_ratio:
        message.format = FORMAT_WITH_RATIO
    if message.learned_light:
        message.format = FORMAT_WITH_GUIDE
    if not workspace.wavelengths.is_usual:
        message.format = FORMAT_WITH_RANGE
    if message.visible_sky:
        message.format = FORMAT_WITH_SKY
    if workspace.light_groups.names or message.ray_sets:
        message.format = FORMAT_WITH_LIGHT_GROUPS
    if any(response.stokes for response in message.sensor.further_responses):
        message.format = FORMAT_WITH_STOKES


def _glows(message: scene_pb2.CompiledScene) -> bool:
    return any(medium.HasField("temperature") for medium in message.media)


def _has_tilted_normals(message: scene_pb2.CompiledScene) -> bool:
    return any(each.HasField("normal_map") or each.HasField("bump_map") for each in message.surfaces)


def _refuse_photons_of_luminaires(workspace: Workspace, message: scene_pb2.CompiledScene) -> None:
    """Where they would not bring all light, or bring it wrong."""
    meter = workspace.document.sensor.type in MET_BY_PHOTONS
    if fluoresces(workspace.kernels.messages, message.media):
        _refuse_all_but_plain(workspace, "fluoresce")
    if is_polarised(message, workspace.kernels.messages):
        _refuse_all_but_plain(workspace, "know how light is polarised")
    if has_sky(message) and message.unbounded_interiors:
        # They start on a ball around the scene, and would not know what media weaken or scatter before that.
        told = "photons of distant light can't start in unbounded media"
        _refuse_photons(workspace, told, "forward", "both")
    if has_sky(message) and workspace.document.atmosphere is not None:
        # None would meet a film, and aimed ones start in steps of half a metre: single precision, a planet's
        # radius away.
        told = "photons of distant light would start all around the atmosphere's planet"
        _refuse_photons(workspace, told, "forward", "both")
    if _glows(message) and meter:
        # Media are no luminaires. A camera's own photons count their glow.
        told = "photons can't start where media glow, so that a meter would miss that light"
        _refuse_photons(workspace, told, "forward")
    if _has_tilted_normals(message) and meter:
        # Where a texture tilts a normal away from who looks, the surface's own counts; where it tilts it away
        # from the light, none comes. A meter that looks over such a floor at a low angle read a fifth less.
        told = "photons from luminaires do not know from where a normal map or a bump map is looked at"
        _refuse_photons(workspace, told, "forward")


def _refuse_all_but_plain(workspace: Workspace, what: str) -> None:
    """Of photons that do what only those from the sensor can, each for itself."""
    _refuse_photons(workspace, f"photons from luminaires do not {what}", "forward", "both")
    if workspace.document.tracing.sharing not in ("auto", 1):
        told = f"pixels whose photons {what} can't share them; expected 1"
        workspace.problems.append(Problem("$.tracing.sharing", told))


def _refuse_photons(workspace: Workspace, told: str, *directions: str) -> None:
    """A pilot does not choose them either."""
    workspace.photons_can_start = False
    if workspace.document.tracing.direction in directions:
        workspace.problems.append(Problem("$.tracing.direction", f'{told}; expected "adjoint"'))


def _all_surfaces(workspace: Workspace, instances: Instances) -> Iterator[tuple[Surface, int, str]]:
    met = set(met_surfaces(workspace.document))
    for index, surface in enumerate(workspace.document.surfaces):
        place = path(("surfaces", index))
        if index in met:
            yield surface, 0, place
        else:
            workspace.dropped.append(f"{place}: all light passes it, and it emits none")
    for lamps, (surface, place) in enumerate(instances.lamps(), start=1):
        if lamps > bounds.SURFACES:
            told = f"shows more than {bounds.SURFACES} lamps with a photometric file, lumens or watts"
            workspace.problems.append(Problem("$.instances", told))
            break
        # Once for all of its places.
        if not any(problem.place.startswith(f"{place}.") for problem in workspace.problems):
            yield surface, 0, place
    yield from instances.surfaces()


def _check_light(workspace: Workspace, message: scene_pb2.CompiledScene) -> None:
    if workspace.problems or message.luminaires or message.ray_sets or _glows(message):
        return
    if not has_sky(message):
        workspace.problems.append(
            Problem("$.surfaces", f"no luminaire emits {workspace.light}, so the image would be black")
        )
