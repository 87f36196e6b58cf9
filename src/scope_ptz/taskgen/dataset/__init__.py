"""Build and describe the published dataset.

``build`` writes the splits, the validation report and the gold runs, and ``unseen`` builds the unseen split. ``distributions``
counts tasks, and ``card`` writes the dataset card.
"""
