"""Find and load plug-ins, which installed packages declare as entry points.

Loading or calling a broken plug-in raises ``ConfigError``, whatever is wrong with it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Any, TypeVar

from scope_ptz.errors import ConfigError, ScopeError

CAMERAS = "scope_ptz.cameras"
PLANNERS = "scope_ptz.planners"
PERCEPTION = "scope_ptz.perception"

_Product = TypeVar("_Product")


@dataclass(frozen=True, slots=True)
class InstalledEntry:
    """An entry point in one of the groups above. Finding it does not import its package.

    Attributes:
        group: The entry-point group.
        name: The declared name of the factory, with hyphens replaced by underscores.
        package: The distribution and its version, for example ``scope-yard 1.2``.
        target: The factory as ``module:attribute``.
        point: The entry point that imports the factory.
    """

    group: str
    name: str
    package: str
    target: str
    point: EntryPoint

    def load(self) -> Callable[..., Any]:
        """Import the package and return its factory.

        Raises:
            ConfigError: The import fails, or the target is not callable.
        """
        try:
            factory = self.point.load()
        except Exception as error:  # code of another package may fail in any way
            raise ConfigError(f"The plug-in '{self.name}' ({self.package}) cannot be loaded: {one_line(error)}.") from error
        if not callable(factory):
            raise ConfigError(
                f"The plug-in '{self.name}' ({self.package}) declares {self.target} as its factory, but that is not "
                f"callable: it is of type {type(factory).__name__}."
            )
        callable_factory: Callable[..., Any] = factory
        return callable_factory


def call_factory(entry: InstalledEntry, contract: type[_Product], spec: object) -> _Product:
    """Call a plug-in's factory and check the type of its product.

    Args:
        entry: The plug-in.
        contract: The abstract class that the product must subclass.
        spec: The factory's only argument.

    Raises:
        ConfigError: Loading or calling the factory fails, or it returns an object of another type.
    """
    factory = entry.load()
    try:
        product = factory(spec)
    except ScopeError:
        raise
    except Exception as error:  # code of another package may fail in any way
        raise ConfigError(f"The plug-in '{entry.name}' ({entry.package}) failed: {one_line(error)}.") from error
    return expect_product(entry, contract, product)


def expect_product(entry: InstalledEntry, contract: type[_Product], product: object) -> _Product:
    """Return a factory's product after checking that it is an instance of the contract.

    Raises:
        ConfigError: The product is of another type.
    """
    if not isinstance(product, contract):
        raise ConfigError(
            f"The plug-in '{entry.name}' ({entry.package}) returned an object of type {type(product).__name__}; "
            f"it must be an instance of {contract.__module__}.{contract.__name__}."
        )
    return product


def normalised(name: str) -> str:
    """Normalise a name for comparison: hyphens become underscores."""
    return name.replace("-", "_")


def installed(group: str) -> tuple[InstalledEntry, ...]:
    """Return the entry points of a group, sorted by name, without importing them."""
    entries = [
        InstalledEntry(group, normalised(point.name), _package(point), point.value, point) for point in entry_points(group=group)
    ]
    return tuple(sorted(entries, key=lambda entry: (entry.name, entry.package)))


def find(group: str, name: str) -> InstalledEntry | None:
    """Return the entry point with the given name, or None if no installed package declares it.

    Raises:
        ConfigError: Several installed packages declare the name.
    """
    key = normalised(name)
    matches = [entry for entry in installed(group) if entry.name == key]
    if len(matches) > 1:
        packages = " and ".join(entry.package for entry in matches)
        raise ConfigError(f"Several packages provide '{name}': {packages}. Uninstall one of them.")
    return matches[0] if matches else None


def duplicated_names(group: str) -> frozenset[str]:
    """Return the names that more than one package declares."""
    counts = Counter(entry.name for entry in installed(group))
    return frozenset(name for name, number in counts.items() if number > 1)


def one_line(error: BaseException) -> str:
    """Return an exception as one line of at most 200 characters, without a final full stop."""
    text = " ".join(f"{type(error).__name__}: {error}".split()).rstrip(".: ")
    return text if len(text) <= 200 else text[:197] + "..."


def _package(point: EntryPoint) -> str:
    return f"{point.dist.name} {point.dist.version}" if point.dist is not None else "an unknown package"
