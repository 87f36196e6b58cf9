"""Creation of benchmark tasks, from the ground truth of scenes to the published dataset.

The packages and modules, in the order in which a dataset passes through them:

- ``facts`` is shared by authoring and validation: robust ground truth, kinds of objects, correct and wrong answer texts.
- ``authoring`` drafts tasks from scenes, selects them and assembles a dataset.
- ``generating`` has a language model draft additional tasks, and ``importing`` reads tasks in the paper's format.
- ``validation`` checks that reference programs pass and adversarial attempts fail.
- ``gold`` inserts known faults into passing runs, to test the judges and the rules that assign error modes.
- ``picture_audit`` compares the expected answers with those of people or models that see only the pictures, which
  ``audit_questions`` writes. ``task_sheet`` shows a single task to a person.
- ``dataset`` builds the unseen split and writes the dataset card.

Callers pass a perception backend as an argument, so this package does not depend on any backend.
"""
