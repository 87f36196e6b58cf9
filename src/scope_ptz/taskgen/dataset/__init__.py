"""The published dataset.

``build`` writes all of its files, ``unseen`` builds the unseen split, ``distributions`` counts tasks, and ``card`` writes the
dataset card.
"""
