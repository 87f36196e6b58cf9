"""Perception backends behind one interface."""
