"""Creation of cameras, planners, perception and evaluation contexts from specs and options. No other package creates them."""
