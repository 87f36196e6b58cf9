"""The agent: the loop that carries out an instruction, the trace that records the run, replays and filmstrips."""
