"""Everything of a road-works site that is not a person, a vehicle or a sign; see the modules that it gathers."""

from scope_ptz.studio.kit.works_barriers import (
    barrier_board,
    chapter8_barrier,
    concrete_barrier,
    cone,
    delineator,
    drum,
    gate,
    mesh_fence_panel,
    water_barrier,
)

__all__ = [
    "barrier_board",
    "chapter8_barrier",
    "concrete_barrier",
    "cone",
    "delineator",
    "drum",
    "gate",
    "mesh_fence_panel",
    "water_barrier",
]
