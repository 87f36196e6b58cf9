"""Buildings, their shop fronts and wall materials, bridges and other structures, and distant buildings with lit windows."""
