"""Street, roadside and market furniture."""
