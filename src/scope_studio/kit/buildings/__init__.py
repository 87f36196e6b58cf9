"""Buildings, their shop fronts and wall materials, bridges and other structures, and lit buildings on a distant skyline."""
