"""Planners behind one contract."""
