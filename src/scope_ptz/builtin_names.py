"""Names of the built-in planners, perception backends and cameras, as used in options, traces, evaluation logs and reports."""

GRAMMAR = "grammar"
"""The rule-based planner."""

CHAT = "chat"
"""The planner that asks a chat model on an OpenAI-compatible server."""

HYBRID_PREFIX = "hybrid:"
"""The prefix of hybrid planners: in "hybrid:qwen3.5-4b", the grammar plans what it understands, and the model plans the rest."""

GROUND_TRUTH = "ground-truth"
"""Perception that reads the simulator's ground truth."""

NOISY = "noisy"
"""Ground truth with simulated perception errors."""

NOISY_SOURCE = "noisy-ground-truth"
"""The ``source`` of results from noisy perception."""

SERVED_TRUTH = "simulation-only-truth"
"""Perception that asks a virtual camera on the same machine for the ground truth of its frames."""

EXACT_PERCEPTION = (GROUND_TRUTH, SERVED_TRUTH)
"""Perception backends whose results are always true of the frame."""

BUILT_IN_PERCEPTION = (GROUND_TRUTH, NOISY, SERVED_TRUTH)
DETERMINISTIC = (GRAMMAR, GROUND_TRUTH, NOISY, SERVED_TRUTH)
"""Planners and perception backends that need no model: the same input always gives the same output."""

DEFAULT_SCENE = "highway-works"
"""The scene that commands use by default."""

BLENDER_WINDOW = "blender-window"
"""The camera in the scene that is open in Blender. The add-on connects it to the server."""
