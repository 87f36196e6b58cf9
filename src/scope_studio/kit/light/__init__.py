"""Skies, sunlight, haze and the colour management that belongs to them: daylight, overcast and dusk."""
