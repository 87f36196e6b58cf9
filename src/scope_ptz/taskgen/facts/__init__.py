"""Facts about scenes that tasks are made from: robust ground truth, object kinds, phrasing, similarity."""
