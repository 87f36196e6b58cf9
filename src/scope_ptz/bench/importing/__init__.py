"""Tasks of other people's files: read, mapped to our tools and scenes, checked for what is wrong with them, and made to run."""

from scope_ptz.bench.importing.checking import check_calls_of
from scope_ptz.bench.importing.tasks import ImportedTask, holds_imported, load_imported

__all__ = ["ImportedTask", "check_calls_of", "holds_imported", "load_imported"]
