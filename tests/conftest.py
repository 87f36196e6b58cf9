"""Fixtures for all packages."""

import signal
from collections.abc import Generator

import pytest

from tests.support.fixtures import analytic_folder, analytic_scene, anyio_backend, pictures_dir

__all__ = ["analytic_folder", "analytic_scene", "anyio_backend", "pictures_dir"]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """A test that is skipped in the tier that it belongs to proves nothing, so it fails."""
    report = yield
    if report.skipped and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"skipped, and a skipped test fails its tier: {report.longrepr}"
    return report


# A shell that starts the tests in the background ignores SIGINT, and every program that the tests interrupt would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)
