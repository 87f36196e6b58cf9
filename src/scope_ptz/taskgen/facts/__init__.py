"""Facts about views, objects and answers, shared by the authoring and the validation of tasks.

``robust`` reads the ground truth of a view and reports only facts that are certain. ``kinds`` defines kinds of objects, and which
of them people confuse. ``answer_phrasing`` words correct and wrong answers, and ``near_duplicates`` compares tasks.
"""
