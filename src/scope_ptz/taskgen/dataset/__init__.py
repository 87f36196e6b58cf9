"""The published dataset: ``unseen`` builds the unseen split, ``distributions`` counts tasks, ``card`` writes the dataset card."""
