"""Daylight by place, time and weather: the Sun's position, skies from measured irradiances, weather files."""
