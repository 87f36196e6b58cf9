"""Fixtures for all rooms."""

from tests.support.fixtures import analytic_folder, analytic_scene, anyio_backend

__all__ = ["analytic_folder", "analytic_scene", "anyio_backend"]
