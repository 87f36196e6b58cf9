"""Hooks and fixtures for all tests."""

import gc
import signal
import sys
from collections.abc import Generator
from pathlib import Path

import pytest
from filelock import FileLock
from hypothesis import HealthCheck, settings

from tests.support.fixtures import analytic_folder, analytic_scene, anyio_backend, pictures_dir

__all__ = ["analytic_folder", "analytic_scene", "anyio_backend", "pictures_dir"]


# No deadline and no check for slow examples: a busy machine must not make a test fail.
settings.register_profile("any-machine", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any-machine")


HERE = Path(__file__).parent
FULL_TIER_TIMEOUT_S, CLEAN_UP_TIMEOUT_S = 900, 120
FULL_TIER_ONLY = ("console", "full")
"""Folders whose tests are all marked ``full``. Importing them (a browser, Blender, models) takes seconds in every worker."""


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """In the fast tier, do not collect folders that only the full tier runs, so that they are not imported."""
    fast = config.getoption("markexpr") == "not full"
    return True if fast and collection_path.parent == HERE and collection_path.name in FULL_TIER_ONLY else None


# Disable garbage collection while tests are collected: it finds no garbage, and takes longer than the imports.
gc.disable()


@pytest.hookimpl(wrapper=True)
def pytest_collection(session: pytest.Session) -> Generator[None, object, object]:
    """In a fresh checkout, let one worker compile all modules while the others wait, so that not every worker compiles them."""
    (HERE / "__pycache__").mkdir(exist_ok=True)
    with FileLock(HERE / "__pycache__" / "compiling.lock"):
        if not (sys.dont_write_bytecode or is_compiled()):
            return (yield)
    return (yield)


def is_compiled() -> bool:
    """Return whether the test modules of the fast tier are compiled."""
    folders = [folder for folder in HERE.iterdir() if folder.is_dir() and folder.name not in FULL_TIER_ONLY]
    sources, compiled = (sum(len(list(folder.rglob(f"test_*.{kind}"))) for folder in folders) for kind in ("py", "pyc"))
    return compiled >= sources


def pytest_collection_finish() -> None:
    """Enable garbage collection again. Exclude all objects that exist now from it."""
    gc.collect()
    gc.freeze()
    gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Give tests of the full tier a longer timeout, unless they set their own."""
    for item in items:
        if item.get_closest_marker("full") is not None and item.get_closest_marker("timeout") is None:
            item.add_marker(pytest.mark.timeout(FULL_TIER_TIMEOUT_S))


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_teardown() -> Generator[None, object, object]:
    """Limit the time of fixture teardown. The timer of pytest-timeout ends when a test fails, but its teardown may hang."""
    if not hasattr(signal, "setitimer") or signal.getsignal(signal.SIGALRM) != signal.SIG_DFL:
        return (yield)

    def too_long(*_: object) -> None:
        pytest.fail(f"Timeout: teardown took more than {CLEAN_UP_TIMEOUT_S} s")

    signal.signal(signal.SIGALRM, too_long)
    signal.setitimer(signal.ITIMER_REAL, CLEAN_UP_TIMEOUT_S)
    try:
        return (yield)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, signal.SIG_DFL)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Report skipped tests as failures, because a test must run in the tier that it belongs to."""
    report = yield
    if report.skipped and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"skipped tests count as failures: {report.longrepr}"
    return report


# A shell that starts the tests in the background makes them ignore SIGINT. Programs that tests start would inherit this, and tests
# could not interrupt them.
signal.signal(signal.SIGINT, signal.default_int_handler)
