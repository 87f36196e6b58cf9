"""Sky, light, haze and matching colour management for daylight, overcast weather and dusk."""
