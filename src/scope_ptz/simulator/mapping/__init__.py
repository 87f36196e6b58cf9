"""Maps from the pixels of a view to the stored pictures."""
