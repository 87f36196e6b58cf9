// Display names of states, verdicts, error modes and categories in the Benchmark tab.

export const STATES = { running: "Running", finished: "Finished", cancelled: "Cancelled", failed: "Failed", interrupted: "Interrupted" };
export const VERDICTS = { correct: "correct", incorrect: "wrong", unscored: "unscored", infrastructure: "infrastructure failure" };
export const MODES = {
  lack_of_tool_call: "missing tool call", tool_routing: "wrong tool", scope: "wrong scope", tool_args: "wrong arguments", hallucination: "hallucination",
  vlm_counting: "miscounted", vlm_query: "misperceived", reasoning: "wrong reasoning",
};

export const displayName = (name) => (name === "ocr" ? "OCR" : name.replaceAll("_", " "));
export const percent = (value) => `${(100 * value).toFixed(1)}%`;
