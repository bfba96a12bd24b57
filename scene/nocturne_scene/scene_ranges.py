"""The schedule of a compiled scene: what the scene says about how its film is cut."""

from nocturne.v1 import job_pb2, scene_pb2

from nocturne_scene.blobs import BlobStore
from nocturne_scene.daylight.patches import Patches
from nocturne_scene.daylight_ranges import with_coefficients
from nocturne_scene.quantities import quantity_of
from nocturne_scene.ranges import ForwardPhotons, make_schedule
from nocturne_scene.spectra.wavelength_range import VISIBLE, WavelengthRange

_FORWARD_PHOTONS = {
    scene_pb2.DIRECTION_ADJOINT: ForwardPhotons.NONE,
    scene_pb2.DIRECTION_FORWARD: ForwardPhotons.ALONE,
    scene_pb2.DIRECTION_BOTH: ForwardPhotons.BESIDE,
}


def schedule_for_scene(
    blobs: BlobStore, scene_sha256: str, width: int, height: int, samples: int
) -> job_pb2.RangeSchedule:
    """The schedule of a film of width x height pixels. Raises InputError as `make_schedule`, and NotFound."""
    scene = scene_pb2.CompiledScene.FromString(blobs.path(scene_sha256).read_bytes())
    return schedule_of(scene, width, height, samples)


def schedule_of(
    scene: scene_pb2.CompiledScene, width: int, height: int, samples: int
) -> job_pb2.RangeSchedule:
    """The same of a scene in memory. Raises InputError as `make_schedule`."""
    schedule = make_schedule(
        width,
        height,
        samples,
        [response.name for response in scene.sensor.further_responses],
        forward_photons=_FORWARD_PHOTONS[scene.tracing.direction],
        photons_per_sample=scene.tracing.group,
        forward_ratio=scene.tracing.forward_ratio,
    )
    if scene.HasField("daylight"):
        once = bool(scene.daylight.suns)
        schedule = with_coefficients(schedule, coefficients_of(scene.daylight), once=once)
    schedule.quantity = quantity_of(scene.sensor).name
    within = range_of(scene.sensor)
    if not within.is_usual:
        schedule.first_nm, schedule.last_nm = within.first, within.last
    schedule.way = scene.tracing.way
    schedule.instruments = scene.sensor.instruments
    schedule.warnings.extend(scene.tracing.warnings)
    return schedule


def coefficients_of(message: scene_pb2.DaylightCoefficients) -> int:
    """Numbers of each pixel, as worker/src/scene/scene.h has it."""
    if message.suns:
        return len(message.suns) + 1
    return len(message.patches) or Patches(message.divisions).count


def wavelengths_of(schedule: job_pb2.RangeSchedule) -> WavelengthRange:
    """The wavelengths of a schedule's scene."""
    if not schedule.last_nm:
        return VISIBLE
    return WavelengthRange(schedule.first_nm, schedule.last_nm)


def range_of(sensor: scene_pb2.Sensor) -> WavelengthRange:
    """The wavelengths of a compiled scene."""
    first = sensor.response_first_nm
    return WavelengthRange(first, first + (len(sensor.response_y) - 1) * sensor.response_step_nm)
