"""Task generation: authoring, drafting by language models, importing, validation, gold runs, audits and the published dataset."""
