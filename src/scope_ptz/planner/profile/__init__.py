"""How steadily a planner chooses its tools: whether small edits of the prompt or of the instruction change what it calls."""

from scope_ptz.planner.profile.edits import INSTRUCTION_EDITS, PROMPT_EDITS, Edit
from scope_ptz.planner.profile.report import Sensitivity, measure_sensitivity
from scope_ptz.planner.profile.trials import Row, Trial, ask_once, load_rows, read_rows

__all__ = [
    "INSTRUCTION_EDITS",
    "PROMPT_EDITS",
    "Edit",
    "Row",
    "Sensitivity",
    "Trial",
    "ask_once",
    "load_rows",
    "measure_sensitivity",
    "read_rows",
]
