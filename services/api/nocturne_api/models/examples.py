"""Examples of requests and answers, for the reference. tests/services/test_contract.py checks each."""

from typing import Any

SHA256 = "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae"

SCENE: dict[str, Any] = {
    "nocturne": 1,
    "sensor": {
        "type": "pinhole",
        "position": [0, 0, 4],
        "look_at": [0, 0, 0],
        "up": [0, 1, 0],
        "vertical_field_of_view_degrees": 40,
    },
    "surfaces": [
        {
            "name": "lamp",
            "shape": {"type": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]},
            "kernel": {"type": "lambertian", "reflectance": 0.5},
            "luminaire": {"radiance": {"blackbody": 3000}},
        }
    ],
}

CREATE_RENDER: dict[str, Any] = {
    "request_id": "night-1",
    "name": "lamp",
    "scene": SCENE,
    "width": 640,
    "height": 480,
    "samples": 1024,
    "stop": {"relative_error": 0.01, "until": "07:00 Europe/Berlin"},
    "priority": 100,
    "layers": ["albedo", "normal"],
    "group": "film",
    "tags": ["lobby"],
}

CREATE_GROUP: dict[str, Any] = {
    **{name: value for name, value in CREATE_RENDER.items() if name != "layers"},
    "request_id": "film-1",
    "changes": {"sensor.position[0]": "-1..1"},
    "varied": [{"place": "tracing.seed", "values": [1, 2]}],
    "frames": {"first": 1, "last": 6},
}

USAGE: dict[str, Any] = {
    "core_hour_price": 0.04,
    "currency": "EUR",
    "owners": [
        {
            "owner": "ann",
            "weight": 100,
            "renders": 31,
            "open_renders": 2,
            "share": 0.75,
            "cpu_seconds": 90000.0,
            "cost": 1.0,
            "stored_bytes": 734003200,
        }
    ],
}

GROUP: dict[str, Any] = {
    "name": "film",
    "renders": 240,
    "ended": 12,
    "failed": 0,
    "fraction": 0.0625,
    "cpu_seconds": 5400.0,
    "predicted_end": 1795306000.0,
}

PREFLIGHT: dict[str, Any] = {"scene": SCENE, "width": 640, "height": 480, "error": 0.02, "budget_seconds": 60}

IMPORT: dict[str, Any] = {
    "files": {"room/scene.gltf": SHA256, "room/scene.bin": SHA256},
    "scene": "room/scene.gltf",
    "allow_missing": True,
    "light": "studio",
    "time": None,
    "parameters": {},
}

RENDER: dict[str, Any] = {
    "id": "r-mfzwkzdvnq2a",
    "name": "lamp",
    "state": "RUNNING",
    "reason": "",
    "width": 640,
    "height": 480,
    "samples": 1024,
    "scene_sha256": SHA256,
    "engine": 12,
    "floating_point_profile": "x86-64-avx2",
    "quantity": "luminance",
    "unit": "cd/m2",
    "response_unit": "W m-2 sr-1",
    "first_nm": 360,
    "last_nm": 830,
    "warnings": [
        {
            "kind": "scene",
            "sentence": "$.surfaces[2].shape: bounds a body, and is open: 4 edges belong to one face only; "
            "light that passes there is taken to be inside",
            "parts": [],
        },
        {
            "kind": "missing_in_parts",
            "sentence": "reflections, refractions or caustics of small bright light sources may be missing, "
            "which the standard errors do not show, at pixels x 320 to 335 y 96 to 111 (up to 30% of the "
            "light shown there)",
            "parts": [{"x": 320, "y": 96, "width": 16, "height": 16, "part": 0.3}],
        },
    ],
    "sensor": "pinhole",
    "guided": False,
    "layers": ["albedo", "normal"],
    "group": "film",
    "after": "",
    "tags": ["lobby"],
    "target_unreachable": "",
    "way": "photons from the sensor, shared by blocks of 16 pixels: 5.8 times less time to the same error "
    "than by photons from the sensor, by a pilot of 933,632 photons",
    "sequence": 12,
    "created": 1795305600.0,
    "started": 1795305601.5,
    "ended": 0.0,
    "stop": {
        "relative_error": 0.01,
        "tile_relative_error": 0.0,
        "wall_seconds": 0.0,
        "cpu_seconds": 0.0,
        "until": "07:00 Europe/Berlin",
        "until_time": 1795327200.0,
    },
    "priority": 100,
    "owner": "studio",
    "look_first": {"x": 64, "y": 32, "width": 128, "height": 128},
    "progress": {
        "ranges_done": 1200,
        "ranges_planned": 3600,
        "samples_merged": 78643200,
        "rays": 314572800,
        "invalid_samples": 0,
        "truncated_paths": 0,
        "mean_samples": 256.0,
        "relative_error": 0.021,
        "top_percent_share": 0.04,
        "effective_pixels": 180000.0,
        "mean": 12.7,
        "mean_error": 0.004,
        "zero_pixels": 0,
        "error_warning": "",
        "samples_per_second": 1250000.0,
        "rays_per_second": 5000000.0,
        "cpu_seconds": 500.0,
        "tiles_done": 0,
        "tiles": 300,
        "tiles_failed": 0,
        "audited": 12,
        "unaudited": 1,
        "refused": 0,
        "predicted_end": 1795305900.0,
        "predicted_cpu_seconds": 2000.0,
    },
}

POLARISATION: dict[str, Any] = {
    "degree": 0.312,
    "degree_interval": [0.308, 0.317],
    "angle_degrees": 87.2,
    "angle_error": 0.4,
}

READING: dict[str, Any] = {
    "region": {"x": 40, "y": 60, "width": 16, "height": 16},
    "quantity": "luminance",
    "unit": "cd/m2",
    "response_unit": "W m-2 sr-1",
    "values": [
        {"name": "X", "mean": 41.2, "standard_error": 0.31},
        {"name": "Y", "mean": 43.5, "standard_error": 0.29},
        {"name": "Z", "mean": 12.8, "standard_error": 0.14},
        {"name": "rod", "mean": 0.051, "standard_error": 0.0004},
    ],
    "u_prime": 0.2256,
    "v_prime": 0.5358,
    "u_prime_error": 0.0011,
    "v_prime_error": 0.0006,
    "correlation": 1.04,
    "coverage_factor": 1.97,
    "pixels": 256,
    "zero_pixels": 0,
    "samples": 16384,
    "fewest_samples": 64,
    "most_samples": 64,
    "invalid_samples": 0,
    "linear_polarisation": POLARISATION,
}

OUTLINE: dict[str, Any] = {"name": "desk", "kind": "polygon", "points": [[8, 8], [24, 8], [16, 20]]}

MEASUREMENTS: dict[str, Any] = {
    "quantity": "illuminance",
    "unit": "lx",
    "channel": "Y",
    "measurements": [
        {
            "outline": {"name": "desk", "kind": "rectangle", "points": [[8.0, 8.0], [24.0, 24.0]]},
            "pixels": 256,
            "zero_pixels": 0,
            "mean": 512.0,
            "mean_error": 1.2,
            "minimum": {"x": 9, "y": 23, "value": 318.0, "standard_error": 4.1, "place": [1.9, 0.75, 4.7]},
            "maximum": {"x": 16, "y": 8, "value": 640.0, "standard_error": 5.2, "place": [3.3, 0.75, 1.7]},
            "u0": 0.621,
            "u0_error": 0.008,
            "ud": 0.497,
            "ud_error": 0.0076,
            "profile": [],
            "profile_csv": "",
            "histogram": {
                "edges": [300.0, 400.0, 500.0, 600.0, 700.0],
                "counts": [20, 76, 120, 40],
                "outside": 0,
                "logarithmic": False,
            },
            "colour": [{"name": "Ra", "value": 84.8, "standard_error": 0.12, "unit": ""}],
            "daylight_factor": {
                "mean": 4.1,
                "mean_error": 0.014,
                "minimum": 1.12,
                "minimum_error": 0.03,
            },
            "linear_polarisation": POLARISATION,
        }
    ],
    "csv": "name,kind,points,quantity,unit,pixels,mean,mean_error,...",
}

EXPLANATION: dict[str, Any] = {"sentence": "It is running on 16 worker threads, shared with 2 other renders."}

WORKER: dict[str, Any] = {
    "id": "w-7",
    "engine": 1,
    "threads": 16,
    "rays_per_second": 5000000.0,
    "jobs_done": 240,
    "started": 1795305000.0,
    "quarantine": "",
    "drain": "",
    "unaudited": "",
    "floating_point_profile": "x86-64-avx2",
    "incompatible": "",
}

WEBHOOK: dict[str, Any] = {
    "id": "wh-5k2q",
    "owner": "studio",
    "url": "https://example.org/nocturne",
    "created": 1795305600.0,
    "last_outcome": "answered 204",
}

NEW_WEBHOOK: dict[str, Any] = {
    **WEBHOOK,
    "last_outcome": "",
    "secret": "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw",
}

ASSET: dict[str, Any] = {"sha256": SHA256, "size_bytes": 3}

PROBLEM: dict[str, Any] = {
    "type": "about:blank",
    "title": "The request is not valid",
    "status": 422,
    "detail": "$.width: is 0 pixels; expected 1 to 16384",
    "reason": "INVALID_INPUT",
    "problems": [{"place": "$.width", "message": "is 0 pixels; expected 1 to 16384"}],
}
