"""A virtual network camera: a scene served over the protocols of real pan-tilt-zoom cameras."""
