"""Judge runs with language models, store human labels, and measure the agreement between raters."""
