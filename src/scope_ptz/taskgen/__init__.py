"""Creation of benchmark tasks, from the ground truth of scenes to the published dataset.

The packages and modules, in the order in which a dataset passes through them:

- ``facts`` is shared by authoring and validation: robust ground truth, kinds of objects, correct and wrong answer texts.
- ``authoring`` drafts tasks from scenes, selects them and assembles a dataset.
- ``generating`` has a language model draft additional tasks, and ``importing`` reads tasks in the paper's format.
- ``validation`` checks that reference programs pass and adversarial attempts fail.
- ``gold`` inserts known faults into passing runs, to test the judges and the rules that assign error modes.
- ``audit_questions`` writes questions with pictures for people and models, and ``picture_audit`` compares their answers with the
  expected ones. ``task_sheet`` shows a person a single task.
- ``dataset`` builds the published dataset and writes the dataset card.

Callers pass a perception backend as an argument, so this package does not depend on any backend.
"""
