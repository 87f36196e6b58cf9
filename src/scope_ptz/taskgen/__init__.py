"""Making of benchmark tasks, from the ground truth of scenes to the published dataset.

The packages follow one another:

- ``facts`` holds what making and validation share: robust ground truth, kinds of objects, right and wrong answers in words.
- ``authoring`` drafts tasks from scenes, selects them and assembles a dataset.
- ``generating`` lets a language model draft further tasks, and ``importing`` reads tasks in the paper's format.
- ``validation`` proves that reference programs pass and adversarial attempts fail.
- ``gold`` puts known faults into passing runs, to test the rules for error modes and the judges.
- ``picture_audit`` compares the expected answers with those of readers who see only the pictures.
- ``dataset`` builds the unseen split and writes the dataset card.

Perception is passed in by the caller; this package never imports it.
"""
