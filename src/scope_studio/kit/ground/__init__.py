"""Ground: a dual carriageway, terrain, paving, wet streets, and road markings."""
