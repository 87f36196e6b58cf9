"""Tasks of other people's files: read, mapped to our tools and scenes, checked for what is wrong with them, and made to run."""

from scope_ptz.bench.scoring.imported import check_calls_of
from scope_ptz.bench.tasks.imported import ImportedTask, holds_imported, load_imported

__all__ = ["ImportedTask", "check_calls_of", "holds_imported", "load_imported"]
