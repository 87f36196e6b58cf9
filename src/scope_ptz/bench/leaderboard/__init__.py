"""A static leaderboard page, made from a folder of submissions."""
