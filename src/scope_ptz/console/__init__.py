"""The operator console: Streamlit with the HTTP API mounted next to it, in one process and on one port."""
