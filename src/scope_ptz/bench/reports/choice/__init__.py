"""The first screen of a report: which pair to choose for which accuracy, latency and memory."""
