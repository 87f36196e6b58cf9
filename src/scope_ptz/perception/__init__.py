"""Eyes behind one contract."""
