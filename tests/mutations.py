"""Messages made wrong: the fields that a decoder would rather not meet, and bytes that are no message."""

import math
import random
from typing import Any

from google.protobuf.descriptor import FieldDescriptor
from google.protobuf.message import Message

_FLOATS = (0.0, -0.0, -1.0, 1e-300, 1e300, math.inf, -math.inf, math.nan)
_INTEGERS = (0, 1, 2, 3, 255, 2**16, 2**31 - 1, 2**31, 2**32 - 1, 2**63 - 1, 2**63, 2**64 - 1, -1, -(2**31))


def mutated(message: Message, random_: random.Random) -> bytes:
    """Serialised, with one to four fields or bytes changed."""
    changed = type(message).FromString(message.SerializeToString())
    for _ in range(random_.randint(1, 4)):
        _change_a_field(changed, random_)
    data = bytearray(changed.SerializeToString())
    if random_.random() < 0.3 and data:
        for _ in range(random_.randint(1, 4)):
            data[random_.randrange(len(data))] = random_.randrange(256)
    if random_.random() < 0.1:
        del data[random_.randrange(len(data) + 1) :]
    return bytes(data)


def _change_a_field(message: Any, random_: random.Random) -> None:
    fields = message.DESCRIPTOR.fields
    present = [field for field, _ in message.ListFields()]
    # Mostly a field that is present; sometimes an absent one.
    field = random_.choice(present if present and random_.random() < 0.85 else fields)
    inside = field.message_type is not None
    if field.is_repeated:
        values = getattr(message, field.name)
        if inside and values and random_.random() < 0.8:
            _change_a_field(random_.choice(values), random_)
            return
        act = random_.randrange(3)
        if act == 0 and values:
            del values[random_.randrange(len(values)) :]
        elif act == 1 and values:
            values.extend([random_.choice(values)] * random_.randint(1, 3))
        elif not inside and (values or act == 2):
            values.insert(random_.randrange(len(values) + 1), _value(field, random_))
    elif not inside:
        setattr(message, field.name, _value(field, random_, getattr(message, field.name)))
    elif random_.random() < 0.1:
        message.ClearField(field.name)
    else:
        child = getattr(message, field.name)
        child.SetInParent()
        if field.message_type.fields:
            _change_a_field(child, random_)


def _value(field: FieldDescriptor, random_: random.Random, before: Any = None) -> Any:
    if field.cpp_type in (field.CPPTYPE_DOUBLE, field.CPPTYPE_FLOAT):
        return random_.choice(_FLOATS)
    if field.cpp_type == field.CPPTYPE_BOOL:
        return random_.random() < 0.5
    if field.cpp_type == field.CPPTYPE_STRING:
        data = bytearray(before if isinstance(before, bytes) else (before or "").encode())
        data[random_.randint(0, len(data)) :] = random_.randbytes(random_.choice((0, 1, 8, 32)))
        return bytes(data) if field.type == field.TYPE_BYTES else data.decode("utf-8", "replace")
    low, high = {
        field.CPPTYPE_INT32: (-(2**31), 2**31 - 1),
        field.CPPTYPE_ENUM: (-(2**31), 2**31 - 1),
        field.CPPTYPE_UINT32: (0, 2**32 - 1),
        field.CPPTYPE_INT64: (-(2**63), 2**63 - 1),
    }.get(field.cpp_type, (0, 2**64 - 1))
    return random_.choice([value for value in _INTEGERS if low <= value <= high])
