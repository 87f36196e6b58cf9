"""Making the tasks of a dataset from the ground truth of scenes: seeded, and the same bytes for the same scenes and seed."""
