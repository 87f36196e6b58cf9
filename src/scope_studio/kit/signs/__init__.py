"""Signs: road signs, gantries, variable message signs, lettering."""
