"""The implementation of the public Python interface. Import its names from ``scope_ptz``, not from here."""
