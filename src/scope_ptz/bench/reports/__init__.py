"""Reports on evaluations, with tables, charts and pages of failed tasks, and submissions to the leaderboard."""
