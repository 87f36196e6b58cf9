"""Tasks of other people's files: read, mapped to our tools and scenes, checked for what is wrong with them, and made to run."""

from scope_ptz.bench.scoring.imported_check import check_imported_calls
from scope_ptz.bench.tasks.imported import ImportedTask, holds_imported, load_imported

__all__ = ["ImportedTask", "check_imported_calls", "holds_imported", "load_imported"]
