"""What a part of a render's image shows, in words."""

from nocturne_client.contract import LinearPolarisation, Reading, Region
from nocturne_client.errors import NocturneClientError

CONFIDENCE = 1.96
"""Standard errors to each side of a 95 % interval, where these are well known."""

_NONE_OF_N = 3.0
"""Of n samples none met light: with 95 %, fewer than 3 in n do. Hanley and Lippman-Hand, "If nothing goes
wrong, is everything all right?" (JAMA 249, 1983)."""


def parse_region(text: str) -> Region:
    """From "X,Y,WIDTH,HEIGHT", pixels from the upper left corner; "X,Y" is one pixel.

    Raises NocturneClientError.
    """
    parts = [each.strip() for each in text.split(",")]
    if len(parts) not in (2, 4) or not all(each.isascii() and each.isdigit() for each in parts):
        raise NocturneClientError(f"--region {text}: expected X,Y,WIDTH,HEIGHT in pixels, or X,Y")
    numbers = [int(each) for each in parts]
    x, y, width, height = numbers if len(numbers) == 4 else (*numbers, 1, 1)
    if not (width and height):
        raise NocturneClientError(f"--region {text}: has no pixels")
    return Region(x, y, width, height)


def sentence(reading: Reading) -> str:
    """Y with its interval and unit, u' and v', further responses; or that nothing was seen."""
    x, y, z, *further = reading.values
    if y.mean <= 0.0:
        bound = f"fewer than 1 in {reading.samples / _NONE_OF_N:,.0f} meet any (95 %)"
        return f"nothing seen: none of {reading.samples:,} samples met light" + (
            f", so {bound}" if reading.samples > _NONE_OF_N else ""
        )
    factor = reading.coverage_factor or CONFIDENCE
    with_error = interval(y.mean, y.standard_error, ".5g", factor)
    told = [f"{reading.quantity or 'Y'} {with_error} {reading.unit}".rstrip()]
    if reading.u_prime is not None and reading.v_prime is not None:
        told.append(f"u' {interval(reading.u_prime, reading.u_prime_error, '.4f', factor)}")
        told.append(f"v' {interval(reading.v_prime, reading.v_prime_error, '.4f', factor)}")
    told += [
        f"{value.name} {interval(value.mean, value.standard_error, '.5g', factor)}"
        for value in (x, z, *further)
    ]
    if reading.linear_polarisation is not None:
        told.append(polarised(reading.linear_polarisation))
    confidence = "" if y.standard_error is None else " (95 %)"
    unseen = f"; nothing seen in {reading.zero_pixels:,} of {reading.pixels:,} pixels"
    return ", ".join(told) + confidence + (unseen if reading.zero_pixels else "")


def polarised(found: LinearPolarisation) -> str:
    """Degree and angle of linear polarisation, with their 95 % intervals where these are known."""
    told = f"linearly polarised by {found.degree:.4g}"
    if found.degree_interval:
        told += " ({:.4g} to {:.4g})".format(*found.degree_interval)
    told += f", at {found.angle_degrees:.1f}"
    return f"{told}{'' if found.angle_error is None else f' +- {found.angle_error:.2g}'} degrees"


def interval(value: float, error: float | None, form: str, factor: float = CONFIDENCE) -> str:
    """A value with half its 95 % interval, so many times its standard error, where that is known."""
    return f"{value:{form}}" + ("" if error is None else f" +- {rounded(factor * error, 2)}")


def rounded(value: float, digits: int) -> str:
    """With so many digits that count, and without a power of ten below a million."""
    return f"{float(f'{value:.{digits}g}'):g}"
