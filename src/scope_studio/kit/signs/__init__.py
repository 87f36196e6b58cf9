"""Road signs, gantries, variable message signs, and their faces and stands."""
