"""The first screen of a report, which helps to choose a pair by accuracy, latency and memory."""
