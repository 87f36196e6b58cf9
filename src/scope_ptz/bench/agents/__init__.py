"""External agents: the agent protocol, and the channels that carry its messages.

The scorer's process sends an agent the instruction, the tools and the results of its calls. Tasks, ground truth and checks never
leave the scorer's process.
"""
