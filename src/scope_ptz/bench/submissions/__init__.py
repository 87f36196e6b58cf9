"""Write and validate submissions for a public leaderboard."""
