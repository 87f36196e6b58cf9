"""Furniture of streets, squares, markets, shops and cafés."""
