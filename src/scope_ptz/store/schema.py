"""The store's tables, for queries. The scripts in ``migrations`` create them."""

from __future__ import annotations

from sqlalchemy import Column, Float, ForeignKey, Integer, MetaData, String, Table, Text

metadata = MetaData()

RUNS = Table(
    "runs",
    metadata,
    Column("number", Integer, primary_key=True),
    Column("id", String, nullable=False, unique=True),  # the name of the run folder
    Column("kind", String, nullable=False),
    Column("conversation", String),
    Column("actor", String, nullable=False),
    Column("started", Float, nullable=False),  # seconds since 1970
    Column("ended", Float),
    Column("instruction", Text, nullable=False),
    Column("answer", Text, nullable=False),
    Column("outcome", String, nullable=False),
    Column("planner", String, nullable=False),
    Column("perception", String, nullable=False),
    Column("camera", String, nullable=False),
    Column("scene", String),
    Column("simulated", Integer, nullable=False),
    Column("version", String, nullable=False),
    Column("steps", Integer, nullable=False),
    Column("calls", Integer, nullable=False),
    Column("failed_calls", Integer, nullable=False),
    Column("total_s", Float, nullable=False),
    Column("planner_s", Float, nullable=False),
    Column("perception_s", Float, nullable=False),
    Column("camera_s", Float, nullable=False),
    Column("render_s", Float, nullable=False),
    Column("input_tokens", Integer, nullable=False),
    Column("output_tokens", Integer, nullable=False),
    Column("kept", Integer, nullable=False, default=0),
    Column("trace_bytes", Integer, nullable=False),  # size of the indexed trace; a different size on disk means that it has changed
    Column("folder_bytes", Integer, nullable=False),
)

STEPS = Table(
    "steps",
    metadata,
    Column("run", Integer, ForeignKey("runs.number", ondelete="CASCADE"), primary_key=True),
    Column("position", Integer, primary_key=True),  # index of the call in the run, from 0
    Column("step", Integer, nullable=False),
    Column("tool", String, nullable=False),
    Column("arguments", Text, nullable=False),  # JSON
    Column("message", Text, nullable=False),
    Column("fault", String),
    Column("pan_deg", Float, nullable=False),
    Column("tilt_deg", Float, nullable=False),
    Column("zoom", Float, nullable=False),
    Column("total_s", Float, nullable=False),
    Column("perception_s", Float, nullable=False),
    Column("camera_s", Float, nullable=False),
    Column("render_s", Float, nullable=False),
)

FRAMES = Table(
    "frames",
    metadata,
    Column("run", Integer, ForeignKey("runs.number", ondelete="CASCADE"), primary_key=True),
    Column("name", String, primary_key=True),  # path in the run folder
    Column("position", Integer),  # index of the call that took it; null for the first view
)

FEEDBACK = Table(
    "feedback",
    metadata,
    Column("id", Integer, primary_key=True),
    Column("run", Integer, ForeignKey("runs.number", ondelete="CASCADE"), nullable=False),
    Column("position", Integer),  # index of the call that it is about; null for the whole run
    Column("rating", Integer, nullable=False),
    Column("comment", Text, nullable=False),
    Column("actor", String, nullable=False),
    Column("created", Float, nullable=False),
)

CONVERSATIONS = Table(
    "conversations",
    metadata,
    Column("id", String, primary_key=True),
    Column("camera", String, nullable=False),
    Column("pair", String, nullable=False),
    Column("owner", String, nullable=False),
    Column("title", Text, nullable=False),
    Column("created", Float, nullable=False),
    Column("updated", Float, nullable=False),
)

AUDIT_FILES = Table(
    "audit_files",
    metadata,
    Column("number", Integer, primary_key=True),
    Column("path", String, nullable=False, unique=True),
    Column("offset", Integer, nullable=False),  # number of bytes indexed so far
)

AUDIT = Table(
    "audit",
    metadata,
    Column("number", Integer, primary_key=True),
    Column("file", Integer, ForeignKey("audit_files.number", ondelete="CASCADE"), nullable=False),
    Column("time", Float, nullable=False),
    Column("camera", String, nullable=False),
    Column("actor", String, nullable=False),
    Column("event", String, nullable=False),
    Column("details", Text, nullable=False),  # JSON
)
