"""Facts about views, objects and answers, shared by task authoring and validation.

``robust`` reads a view's ground truth and reports only facts that are certain. ``kinds`` defines kinds of objects and states which
kinds people confuse. ``answer_phrasing`` phrases correct and wrong answers, and ``near_duplicates`` compares tasks.
"""
