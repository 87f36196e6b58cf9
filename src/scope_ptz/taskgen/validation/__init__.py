"""Validate tasks: reference programs must pass, and adversarial programs and answers must fail.

``adversarial`` creates the attempts at a task, ``consistency`` recomputes its expected answer from the scene, and
``dataset_checks`` compares the tasks with each other. ``validate`` runs all of these and returns a ``validation_report``, which
``report_text`` formats.
"""
