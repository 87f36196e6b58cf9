"""Write and validate submissions to a public leaderboard."""
