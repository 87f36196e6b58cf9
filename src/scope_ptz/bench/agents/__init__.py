"""External agents: the protocol that they speak, and the channels that carry it.

The scorer's process sends an agent the instruction, the tools and the results of calls. Tasks, ground truth and checks never leave
the scorer's process.
"""
