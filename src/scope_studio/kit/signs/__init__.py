"""Road signs, gantries, variable message signs, and the faces and stands that they consist of."""
