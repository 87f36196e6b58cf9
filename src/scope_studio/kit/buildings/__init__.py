"""Buildings, shop fronts and what belongs to their walls."""
