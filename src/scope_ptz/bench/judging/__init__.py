"""Language models as judges of runs, human labels, and the agreement between all raters."""
