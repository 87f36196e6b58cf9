"""Manage the Ed25519 keys of hosts, sign submissions, and determine who evaluated a submission."""
