"""Maps from a view's pixels to the stored pictures."""
