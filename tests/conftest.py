"""Fixtures for all packages."""

import signal
from collections.abc import Generator
from pathlib import Path

import pytest

from tests.support.fixtures import analytic_folder, analytic_scene, anyio_backend, pictures_dir

__all__ = ["analytic_folder", "analytic_scene", "anyio_backend", "pictures_dir"]


TESTS = Path(__file__).parent
ONE_GROUP = ("taskgen/authoring",)
"""Folders whose files share an expensive fixture."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let one worker run all tests of a file (``--dist loadgroup``), so that its fixtures are made once."""
    for item in items:
        file = item.path.relative_to(TESTS).as_posix()
        item.add_marker(pytest.mark.xdist_group(next((folder for folder in ONE_GROUP if file.startswith(folder)), file)))


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
