"""Shared fixtures."""

from tests.support.fixtures import anyio_backend

__all__ = ["anyio_backend"]
