"""The base of every object in a scene document, and how one is chosen among several kinds."""

from collections.abc import Callable, Collection, Mapping
from itertools import islice
from typing import Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator
from pydantic_core import PydanticCustomError

from nocturne_scene.document import bounds

# Fields of the document whose keys are names that people choose and other parts use.
NAMED = ("spectra", "textures", "kernels", "media", "groups")


class Node(BaseModel):
    """An immutable object of a scene document; unknown fields are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


def quoted_list(choices: Collection[str]) -> str:
    """Render names for an error message: `"a", "b"`, shortened when there are many."""
    shown = ", ".join(f'"{choice}"' for choice in islice(choices, bounds.CHOICES_SHOWN))
    rest = len(choices) - bounds.CHOICES_SHOWN
    return f"{shown} and {rest} more" if rest > 0 else shown


def problem_at(suffix: str, message: str) -> PydanticCustomError:
    """Return an error to raise in a validator.

    `suffix` leads from the validated value to the culprit, as in ".type".
    """
    # Braces would be taken for placeholders in a message template, so the text travels as a value.
    return PydanticCustomError("scene", "{message}", {"suffix": suffix, "message": message})


def chosen_by_type(
    kinds: Mapping[str, str], *, or_name: bool = False, tag: Callable[[Any], str | None] | None = None
) -> tuple[BeforeValidator, Discriminator]:
    """Choose among objects by their field "type".

    `kinds` maps its values to tags; `tag` may refine them. With `or_name`, text is a reference, tagged
    "<name>".
    """

    def by_type(value: Any) -> str | None:
        if or_name and isinstance(value, str):
            return "<name>"
        return kinds.get(str(_get(value, "type")))

    choose = tag or by_type

    def check(value: Any) -> Any:
        if choose(value) is None:
            raise _no_such_type(value, list(kinds), or_name)
        return value

    return BeforeValidator(check), Discriminator(choose)


def _no_such_type(value: Any, kinds: list[str], or_name: bool) -> PydanticCustomError:
    if not isinstance(value, dict):
        name = "a name or " if or_name else ""
        return problem_at("", f"expected {name}an object whose type is one of {quoted_list(kinds)}")
    if "type" not in value:
        return problem_at(".type", f"missing; expected one of {quoted_list(kinds)}")
    return problem_at(".type", f"unknown type; expected one of {quoted_list(kinds)}")


def chosen_by_key(
    kinds: Mapping[str, str], otherwise: Callable[[Any], str | None], bare: str
) -> tuple[BeforeValidator, Discriminator]:
    """Choose among objects by the field that only one of them has.

    `otherwise` gives the tag of a value that is no object (None: not allowed), `bare` says in words what
    such values are allowed; empty for none.
    """

    def tag(value: Any) -> str | None:
        if not isinstance(value, dict | BaseModel):
            return otherwise(value)
        return next((kinds[key] for key in kinds if _get(value, key) is not None), None)

    def check(value: Any) -> Any:
        if tag(value) is None:
            others = f"{bare} or " if bare else ""
            raise problem_at(
                "", f"expected {others}an object with one of the fields {quoted_list(list(kinds))}"
            )
        return value

    return BeforeValidator(check), Discriminator(tag)


def _get(value: Any, key: str) -> Any:
    return value.get(key) if isinstance(value, dict) else getattr(value, key, None)
