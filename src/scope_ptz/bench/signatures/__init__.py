"""Ed25519 keys of hosts, detached signatures of submissions, and the check of who evaluated a submission."""
