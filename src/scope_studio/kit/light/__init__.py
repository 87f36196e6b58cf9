"""Sky, light, haze and colour management for daylight, overcast weather and dusk."""
