"""The agent: the loop that carries out an instruction, the trace that records it, replays and filmstrips."""
