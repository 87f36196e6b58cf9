"""A server with cameras in the analytic scene."""

from tests.serve.conftest import scenes, served

__all__ = ["scenes", "served"]
