"""Street and roadside furniture; see the modules that it gathers."""

from scope_studio.kit.furniture.road import (
    bollard,
    cabinet,
    cctv_pole,
    chevron_board,
    drain,
    emergency_phone,
    guardrail,
    lamp_post,
    noise_barrier,
)
from scope_studio.kit.furniture.street import bench, bicycle, bin, bus_shelter  # noqa: A004

__all__ = [
    "bench",
    "bicycle",
    "bin",
    "bollard",
    "bus_shelter",
    "cabinet",
    "cctv_pole",
    "chevron_board",
    "drain",
    "emergency_phone",
    "guardrail",
    "lamp_post",
    "noise_barrier",
]
