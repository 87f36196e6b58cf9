"""``python -m scope_ptz.cli`` is ``scope``."""

from scope_ptz.cli import main

if __name__ == "__main__":
    main()
