"""Language models as judges of runs, people's labels, and how well they all agree."""
