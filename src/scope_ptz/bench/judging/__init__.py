"""Judge runs with language models and human labels, and measure the agreement of all raters."""
