"""Ground, plants, animals and distant surroundings."""
