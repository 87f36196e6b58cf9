"""The operator's page: Streamlit with the HTTP API mounted next to it, in one process and on one port."""
