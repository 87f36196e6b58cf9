"""The answer parser: free text in, a typed value out."""
