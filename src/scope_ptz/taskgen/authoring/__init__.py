"""Authoring of tasks from the ground truth of scenes. The same scenes and seed give the same bytes.

The modules follow one another: ``task_places`` draws the views that tasks are about, ``view_contents``, ``object_names`` and
``zoom_targets`` find what can be asked there, ``categories`` turns it into drafts (``drafts``), ``scene_drafts`` collects them for
a scene, ``selection`` balances them, and ``assembly`` numbers, pairs and paraphrases the result. ``noun_phrases`` holds the
English, and ``reactions`` adds requests that an agent should question or refuse.
"""
