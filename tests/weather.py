"""A year of weather for tests, as an EPW file."""

from datetime import datetime, timedelta

import numpy as np
from nocturne_scene.daylight.solar_position import Place, julian_day, sun_at

_PLACE = Place(48.8, 9.2, 250.0)


def epw() -> str:
    """Of a place at 48.8 degrees north: two clear days, then an overcast one, and so on.

    Clear: direct 900 exp(-0.1 / cos z), diffuse 100 cos z ^ 0.5 W/m2; overcast: diffuse 250 cos z.
    """
    location = f"LOCATION,Testing,-,NOW,none,0,{_PLACE.latitude},{_PLACE.longitude},1.0,{_PLACE.altitude}"
    header = [location, *(f"LINE {number}" for number in range(2, 9))]
    start = datetime.fromisoformat("2001-01-01T00:00+01:00")
    middle = julian_day(start) + (np.arange(8760) + 0.5) / 24
    cosine = np.cos(np.radians(sun_at(middle, _PLACE).zenith))
    rows = []
    for hour in range(8760):
        when = start + timedelta(hours=hour)
        up, clear = max(0.0, float(cosine[hour])), (hour // 24) % 3 < 2
        direct = 900 * np.exp(-0.1 / up) if up > 0 and clear else 0.0
        diffuse = 100 * up**0.5 if clear else 250 * up
        fields = [f"{when.year}", f"{when.month}", f"{when.day}", f"{when.hour + 1}", "0", "flags", "10", "5"]
        fields += ["50", "100000", "0", "0", "300", "0", f"{direct:.1f}", f"{diffuse:.1f}", "0"]
        rows.append(",".join(fields))
    return "\n".join([*header, *rows]) + "\n"
