"""Where a thing stands, as a document says it."""

from typing import Any

from mathutils import Matrix

Json = Any

# How far a scale may differ along the axes before it counts as stretched.
_EVEN = 1e-5


def placement(matrix: Any) -> Json | None:
    """Scale, rotation and shift of a matrix; None where it mirrors or stretches."""
    shift, turn, scale = matrix.decompose()
    factor = sum(scale) / 3
    if factor <= 0:
        return None
    again = Matrix.LocRotScale(shift, turn, (factor,) * 3)
    if any(
        abs(a - b) > _EVEN * factor
        for one, two in zip(matrix.to_3x3(), again.to_3x3(), strict=True)
        for a, b in zip(one, two, strict=True)
    ):
        return None
    found: Json = {"translate": list(shift)} if shift.length > 0 else {}
    if abs(factor - 1) > 1e-6:
        found["scale"] = factor
    axis, angle = turn.to_axis_angle()
    if abs(angle) > 1e-7:
        found["rotate"] = {"axis": list(axis), "degrees": angle * 57.29577951308232}
    return found
