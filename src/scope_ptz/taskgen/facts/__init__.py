"""Facts that the making and the validation of tasks share.

``robust`` reads the ground truth of a view and states only what certainly holds. ``kinds`` defines kinds of objects and which of
them people confuse. ``answer_phrasing`` words right and wrong answers to an expected value, and ``near_duplicates`` compares tasks.
"""
