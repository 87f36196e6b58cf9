"""More tasks: a language model drafts them, programs work out what is right, and only what is proved is kept."""
