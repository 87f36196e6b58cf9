"""Measure how stable a planner's tool choice is under small edits of the prompt or the instruction."""

from scope_ptz.planner.profile.edits import INSTRUCTION_EDITS, PROMPT_EDITS, Edit
from scope_ptz.planner.profile.first_calls import InstructionRow, PlannerTrial, ask_once, load_rows, read_rows
from scope_ptz.planner.profile.prompt_sensitivity import Sensitivity, measure_sensitivity

__all__ = [
    "INSTRUCTION_EDITS",
    "PROMPT_EDITS",
    "Edit",
    "InstructionRow",
    "PlannerTrial",
    "Sensitivity",
    "ask_once",
    "load_rows",
    "measure_sensitivity",
    "read_rows",
]
