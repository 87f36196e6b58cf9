"""Cars, lorries, buses, trams, cycles and machines."""
