"""Recording: planner, perception and tools as models and tools of Inspect, so that its log shows every request."""
