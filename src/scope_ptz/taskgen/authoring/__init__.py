"""Author tasks from the ground truth of scenes. The same scenes and seed always give identical tasks.

The modules are used in this order: ``task_places`` samples the views that tasks are about. ``view_contents``, ``object_names``
and ``zoom_targets`` find the objects that a question can be about. ``categories`` creates the drafts, whose classes are
in ``drafts``, and ``scene_drafts`` collects the drafts of a scene. ``selection`` selects a balanced subset, and ``assembly``
numbers, pairs and paraphrases the selected drafts. ``noun_phrases`` writes English noun phrases, and ``reactions`` adds requests
that an agent should ask about or refuse.
"""
