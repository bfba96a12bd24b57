"""The base of every object in a scene document, and how one is chosen among several kinds."""

from collections.abc import Callable, Collection, Mapping
from functools import reduce
from itertools import islice
from operator import or_
from typing import Annotated, Any, get_args, get_origin

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    GetCoreSchemaHandler,
    Tag,
)
from pydantic_core import CoreSchema, PydanticCustomError

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


def one_of_names(noun: str, names: Collection[str]) -> AfterValidator:
    """Accepts these names alone; `noun` names their kind."""

    def check(name: str) -> str:
        if name not in names:
            shown = name[: bounds.NAME_LENGTH]
            raise problem_at("", f'no {noun} named "{shown}"; expected one of {quoted_list(names)}')
        return name

    return AfterValidator(check)


def tag_of(member: Any) -> str | None:
    """Return how locations of errors name a member of a union; None for a union."""
    given = next((each.tag for each in getattr(member, "__metadata__", ()) if isinstance(each, Tag)), None)
    bare = get_args(member)[0] if get_origin(member) is Annotated else member
    return given or (f"<{bare.__name__}>" if isinstance(bare, type) else None)


class _Chosen:
    """Annotates a union of which one member is chosen before its fields are looked at."""

    def __get_pydantic_core_schema__(self, union: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        members = get_args(union)
        bare = [get_args(each)[0] if get_origin(each) is Annotated else each for each in members]

        def choose(value: Any) -> str | None:
            kind = self._kind(value, bare)
            return None if kind is None else tag_of(kind)

        def check(value: Any) -> Any:
            if choose(value) is None:
                raise self._problem(value, bare)
            return value

        tagged: Any = reduce(or_, (Annotated[each, Tag(str(tag_of(each)))] for each in members))
        return handler.generate_schema(Annotated[tagged, Discriminator(choose), BeforeValidator(check)])

    def _kind(self, value: Any, kinds: list[type]) -> Any:
        raise NotImplementedError

    def _problem(self, value: Any, kinds: list[type]) -> PydanticCustomError:
        raise NotImplementedError


class ByType(_Chosen):
    """By the field "type"; text, where a name may be given, is a name.

    `refine` gets a value and its type, and may choose another member for it.
    """

    def __init__(self, refine: Callable[[Any, str], Any] = lambda *_: None) -> None:
        self._refine = refine

    def _kind(self, value: Any, kinds: list[type]) -> Any:
        if isinstance(value, str) and str in kinds:
            return str
        name = str(field(value, "type"))
        return self._refine(value, name) or _by_type(kinds).get(name)

    def _problem(self, value: Any, kinds: list[type]) -> PydanticCustomError:
        names = quoted_list(_by_type(kinds))
        if not isinstance(value, dict):
            name = "a name or " if str in kinds else ""
            return problem_at("", f"expected {name}an object whose type is one of {names}")
        said = "unknown type" if "type" in value else "missing"
        return problem_at(".type", f"{said}; expected one of {names}")


def _by_type(kinds: list[type]) -> dict[str, type]:
    return {get_args(each.__annotations__["type"])[0]: each for each in kinds if each is not str}


class ByKey(_Chosen):
    """By the field that only one of several kinds of objects has; text and numbers where they are members."""

    def __init__(self, keys: Mapping[str, type[Node]]) -> None:
        self._keys = keys

    def _kind(self, value: Any, kinds: list[type]) -> Any:
        if isinstance(value, dict | BaseModel):
            return next((kind for key, kind in self._keys.items() if field(value, key) is not None), None)
        # True and false are numbers to Python, but not to JSON.
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        bare = str if isinstance(value, str) else float if is_number else None
        return bare if bare in kinds else None

    def _problem(self, value: Any, kinds: list[type]) -> PydanticCustomError:
        del value
        bare = [words for kind, words in ((str, "a name"), (float, "a number")) if kind in kinds]
        others = f"{', '.join(bare)} or " if bare else ""
        fields = quoted_list(list(self._keys))
        return problem_at("", f"expected {others}an object with one of the fields {fields}")


def field(value: Any, key: str) -> Any:
    """Return a field of decoded JSON, or of a node; None without it."""
    return value.get(key) if isinstance(value, dict) else getattr(value, key, None)
