"""Skies and light."""
