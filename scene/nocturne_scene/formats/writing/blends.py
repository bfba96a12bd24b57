"""Blends of kernels, taken apart into blends of two."""

from dataclasses import dataclass

from nocturne.v1 import scene_pb2

Part = tuple[int, tuple[scene_pb2.Blend.Factor, ...]]
"""A kernel of a blend, and the factors of its weight."""


@dataclass(frozen=True)
class Halves:
    """What a blend of more than one kernel is a blend of."""

    weight: scene_pb2.Scalar
    weighed: list[Part]
    """The parts that are there with `weight`."""
    rest: list[Part]


def parts_of(blend: scene_pb2.Blend) -> list[Part]:
    """All kernels of a blend."""
    return [(part.kernel, tuple(part.factors)) for part in blend.parts]


def halves(parts: list[Part]) -> Halves:
    """Take the outermost weight, which is a factor of all parts, from at least two of them."""
    weight = next(
        factor.weight
        for factor in parts[0][1]
        if all(any(factor.weight == each.weight for each in factors) for _, factors in parts)
    )
    found = Halves(weight, [], [])
    for kernel, factors in parts:
        at = next(at for at, each in enumerate(factors) if each.weight == weight)
        half = found.rest if factors[at].complement else found.weighed
        half.append((kernel, factors[:at] + factors[at + 1 :]))
    return found
