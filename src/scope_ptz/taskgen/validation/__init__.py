"""Validation of tasks: reference programs must pass, and adversarial programs and answers must fail.

``adversarial`` makes the attempts at a task, ``consistency`` works its expected value out again from the scene, ``dataset_checks``
compares tasks with one another, and ``validate`` runs everything and collects the ``validation_report``.
"""
