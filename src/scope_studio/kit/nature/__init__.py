"""Plants and animals: trees, hedges, grass, birds, dogs, a fox."""
