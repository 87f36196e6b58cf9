"""Run ``scope`` with ``python -m scope_ptz.cli``."""

from scope_ptz.cli import main

if __name__ == "__main__":
    main()
