"""Parametric objects, materials and light for street scenes."""
