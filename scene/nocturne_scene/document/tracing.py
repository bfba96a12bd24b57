"""How photons are traced, as written in a scene document."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from nocturne_scene.document import bounds
from nocturne_scene.document.fields import Finite, NotNegative
from nocturne_scene.document.node import Node, problem_at

_Weight = Annotated[NotNegative, Field(le=1e6)]


class Mixture(Node):
    """Weights of the techniques for choosing a direction; scaled so that they sum to 1.

    The weights change the noise and not the image, as long as `kernel` or `uniform` is more than 0: without
    both, light that other surfaces scatter is lost. One with weight 0 is never used, nor is one that the
    scene has nothing for. If none of `luminaires`, `environment` and `important` is given, those that the
    scene has share 0.35 in equal parts; if some are given, the others are 0.
    """

    kernel: _Weight = Field(default=0.65, description="In proportion to the kernel.")
    luminaires: _Weight | None = Field(default=None, description="Towards the luminaires on surfaces.")
    environment: _Weight | None = Field(
        default=None, description="In proportion to the environment, and towards discs at infinity."
    )
    important: _Weight | None = Field(
        default=None,
        description="Towards `$.important_directions`. Where no weight is given and both directions are "
        "traced, this may be left out.",
    )
    uniform: _Weight = Field(
        default=0.0, description="Uniformly over the directions that the surface scatters to."
    )

    @property
    def is_open(self) -> bool:
        """Whether the document gives no weights of aimed directions."""
        return self.luminaires is None and self.environment is None and self.important is None

    @model_validator(mode="after")
    def _some_weight(self) -> Self:
        aimed = (self.luminaires, self.environment, self.important)
        given = [weight for weight in aimed if weight is not None]
        if not self.kernel + self.uniform + (sum(given) if given else 1.0) > 0:
            raise problem_at("", "all weights are zero; at least one must be more than 0")
        return self


class Tracing(Node):
    """How photons are traced. None of it changes what the image converges to, except `maximum_depth`."""

    h: Annotated[Finite, Field(gt=0, le=1e6)] | None = Field(
        default=None,
        description="Russian-roulette factor: a photon survives a surface of albedo H with probability "
        "min(1, h H). Default: 4, or 1 with roulette by albedo, where a larger value would never end a path.",
    )
    roulette: Literal["weight", "albedo"] = Field(
        default="weight",
        description="Survival by H h times the weight that the photon carries, or by H h alone (the paper).",
    )
    roulette_after: Annotated[int, Field(strict=True, ge=0, le=bounds.DEPTH)] = Field(
        default=2, description="Interactions that every photon survives; then roulette starts."
    )
    maximum_depth: Annotated[int, Field(strict=True, ge=1, le=bounds.DEPTH)] | None = Field(
        default=None,
        description="Interactions with surfaces and media after which a photon is absorbed; a straight "
        "passage through a pane or a mask does not count. Default: no limit; "
        "a photon ends by leaving, or by roulette once absorption has made it light.",
    )
    estimator: Literal["two_photons", "mixture", "split"] = Field(
        default="two_photons",
        description="Photons that leave a vertex: two, one from the kernel and one towards luminaires "
        "or important directions that ends on the first ordinary surface; or one, drawn from the mixture; or "
        "one of each kind at the first vertices, with power-heuristic weights.",
    )
    split_vertices: Annotated[int, Field(strict=True, ge=1, le=bounds.SPLIT_VERTICES)] = Field(
        default=1, description='At how many vertices the estimator `"split"` splits.'
    )
    mixture: Mixture = Field(default=Mixture(), description="How directions are chosen.")
    photons_together: Literal["auto", 1, 4] = Field(
        default="auto",
        description="How many wavelengths share one path until dispersion or scattering separates them. "
        "`auto`: 1 for `forward` with media, else 4.",
    )
    direction: Literal["auto", "adjoint", "forward", "both"] = Field(
        default="auto",
        description="From the sensor to the luminaires, or the other way round. `auto`: what a pilot of "
        "a few samples finds better, `adjoint` for images of less than 2^18 samples in all. `forward` is "
        "for the irradiance meter and the intensity meter. `both` is for cameras: photons from the "
        "luminaires bring the light that mirrors and glass gather, as from lamps in reflectors and in "
        "caustics, and photons from the camera find all other light. Neither is for luminaires with "
        "textures.",
    )
    sharing: Literal["auto", 1, 16] = Field(
        default="auto",
        description="Pixels that share what their photons find from the second surface on, where that is "
        "diffuse: blocks of 4 x 4, or each alone. `auto`: 16 where a pilot finds that better, else 1. The "
        "image converges to the same; in rooms, where much light comes by way of diffuse surfaces, 16 has "
        "less noise for the same time.",
    )
    aimed_emission: Annotated[Finite, Field(ge=0, le=0.99)] | None = Field(
        default=None,
        description="For photons from luminaires, the sky and the Sun, with `forward` and `both`: the part "
        "that is sent towards `$.important_directions`, such as glass that makes a caustic. The others leave "
        "as the luminaire emits, so that no light is lost. Default: 0, or 0.6 where the pilot "
        "that chooses the direction finds that better; where the scene declares no important directions, the "
        "pilot then learns some for these photons.",
    )
    forward_ratio: Literal["auto"] | Annotated[Finite, Field(ge=1 / 16, le=64)] = Field(
        default="auto",
        description="With `both`: how many photons leave the luminaires for each that leaves a pixel. "
        "`auto`: what the pilot that chooses the direction finds best, else 1.",
    )
    guide: Literal["auto", "none"] = Field(
        default="auto",
        description="Whether photons from the sensor are sent to where light comes from (path guiding). "
        "`auto`: where a pilot finds that better, to what mirrors and glass gather, as photons from the "
        "luminaires have shown, for a caustic that is seen in a mirror or through glass; and in a room to "
        "the part of the sky that is visible from each place, as a few photons from the sensor have shown.",
    )
    sequence: Literal["sobol", "independent"] = Field(
        default="sobol",
        description="Random numbers: Owen-scrambled Sobol points for each pixel, or independent ones.",
    )
    seed: Annotated[int, Field(strict=True, ge=0, lt=2**64)] = Field(
        default=0, description="Chooses the random numbers of the whole image."
    )
