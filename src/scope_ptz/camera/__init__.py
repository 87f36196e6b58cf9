"""Cameras behind one contract."""
