"""A virtual network camera: a scene behind the protocols of real pan-tilt-zoom cameras."""
