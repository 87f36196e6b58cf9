"""Tables of wordings and what replaces them, by what they are about."""
