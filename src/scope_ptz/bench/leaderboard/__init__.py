"""Create a static leaderboard page from a submission folder."""
