"""The store: an SQLite index of run folders, with feedback, conversations and audit logs. Run folders remain the primary data."""
