"""The former name of ``scope_ptz.cli.exit``, for benchmark commands that still import it."""

from scope_ptz.cli.exit import BAD_INPUT, CANCELLED, FAILED, complain, exit_code, put, put_json
from scope_ptz.cli.exit import exit_on_error as ending

__all__ = ["BAD_INPUT", "CANCELLED", "FAILED", "complain", "ending", "exit_code", "put", "put_json"]
