"""Hosted evaluation: participants' agents connect over HTTP or MCP, and never receive the expected answers.

Two kinds of processes share the work. A worker per participant holds the tasks, runs the evaluation engine, and signs the result.
The host listens on the network and passes messages between agents and workers. It never holds tasks, ground truth or the signing
key.
"""
