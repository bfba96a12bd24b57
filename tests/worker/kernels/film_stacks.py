"""Writes film_stacks.txt: 1,000 random stacks, and what the package tmm says of them.

    pip install tmm && python tests/worker/kernels/film_stacks.py > tests/worker/kernels/film_stacks.txt

tmm is S. Byrnes' "Multilayer optical calculations", arXiv 1603.02720; version 0.2.0. Each stack is also
compared with Abeles' characteristic matrices in complex128, which need no package.

A line: wavelength in nm, index here, cosine, number of layers, n, k and thickness in nm of each, n and k
beyond, and the reflectance and transmittance of s, then of p.
"""

import cmath
import math
import random
import sys

Layer = tuple[complex, float]
Shares = tuple[float, float]

COUNT = 1000
AGREE = 1e-9


def stack(chance: random.Random) -> tuple[float, float, float, list[Layer], complex]:
    """From air or from glass, onto glass, metal or air; layers clear, absorbing or metal."""
    layers: list[Layer] = []
    for _ in range(chance.randint(0, 6)):
        kind = chance.random()
        index = complex(round(chance.uniform(1.2, 2.6), 4))
        if kind < 0.3:
            index += 1j * round(10 ** chance.uniform(-4, 0), 6)
        elif kind < 0.45:
            index = complex(round(chance.uniform(0.05, 3.0), 4), round(chance.uniform(0.5, 6.0), 4))
        thick = chance.uniform(1, 40) if index.imag > 0.5 else 10 ** chance.uniform(0.5, 3.5)
        layers.append((index, round(thick, 3)))
    here = chance.choice([1.0, 1.0, 1.5168, round(chance.uniform(1.0, 2.0), 4)])
    beyond = chance.choice([1.0, 1.5168, round(chance.uniform(1.0, 2.5), 4)]) + 0j
    if chance.random() < 0.25:
        beyond = complex(round(chance.uniform(0.05, 3.0), 4), round(chance.uniform(0.5, 6.0), 4))
    cosine = round(chance.choice([1.0, chance.uniform(0.01, 1.0), chance.uniform(0.01, 1.0)]), 6)
    return round(chance.uniform(250, 2500), 3), here, cosine, layers, beyond


def characteristic(polarisation: str, stack: tuple[float, float, float, list[Layer], complex]) -> Shares:
    """Abeles' matrices: F. Abeles, Annales de Physique 12(5), 1950."""
    wavelength, here, cosine, layers, beyond = stack
    along = here * math.sqrt(1 - cosine * cosine)

    def normal(index: complex) -> complex:
        found = cmath.sqrt(index * index - along * along)
        return -found if found.imag < 0 else found

    def admittance(index: complex) -> complex:
        return normal(index) if polarisation == "s" else index * index / normal(index)

    a, b, c, d = 1 + 0j, 0j, 0j, 1 + 0j
    for index, thickness in layers:
        phase, eta = 2 * math.pi * thickness / wavelength * normal(index), admittance(index)
        cos, sin = cmath.cos(phase), cmath.sin(phase)
        e, f, g, h = cos, -1j * sin / eta, -1j * sin * eta, cos
        a, b, c, d = a * e + b * g, a * f + b * h, c * e + d * g, c * f + d * h
    eta0, eta1 = admittance(complex(here)), admittance(beyond)
    electric, magnetic = a + b * eta1, c + d * eta1
    sum_ = eta0 * electric + magnetic
    reflected = abs((eta0 * electric - magnetic) / sum_) ** 2
    return reflected, 4 * eta0.real * eta1.real / abs(sum_) ** 2


def main() -> None:
    """Print the table."""
    import tmm

    chance = random.Random(56)
    worst = 0.0
    for _ in range(COUNT):
        drawn = wavelength, here, cosine, layers, beyond = stack(chance)
        indices = [here, *(index for index, _ in layers), beyond]
        thicknesses = [math.inf, *(thickness for _, thickness in layers), math.inf]
        found: list[float] = []
        for polarisation in "sp":
            by = tmm.coh_tmm(polarisation, indices, thicknesses, math.acos(cosine), wavelength)
            also = characteristic(polarisation, drawn)
            worst = max(worst, abs(by["R"] - also[0]), abs(by["T"] - also[1]))
            found += [by["R"], max(0.0, by["T"])]
        numbers = [part for index, thickness in layers for part in (index.real, index.imag, thickness)]
        row = [wavelength, here, cosine, len(layers), *numbers, beyond.real, beyond.imag]
        sys.stdout.write(" ".join(f"{each:.10g}" for each in [*row, *found]) + "\n")
    if worst > AGREE:
        sys.exit(f"characteristic matrices differ by {worst:g}")


if __name__ == "__main__":
    main()
