"""The script that Streamlit runs for each browser tab.

The script only adds one component, which contains the whole page. The component sends its requests directly to the API, so a
command never waits for the script to rerun, and a rerun never interrupts the live view.
"""

from pathlib import Path

import streamlit as st

_MOUNT_SCRIPT = """
export default function (component) {
  const root = component.parentElement.querySelector("#scope");
  if (root.dataset.mounted) return;
  root.dataset.mounted = "yes";
  import(new URL("/console/main.js", location.origin)).then((page) => page.mount(root));
}
"""
_STYLES = "".join(f'<link rel="stylesheet" href="/console/{name}.css">' for name in ("page", "benchmark", "cameras"))
_INITIAL_HTML = f'{_STYLES}<div id="scope"><p class="starting">Starting the console …</p></div>'

st.set_page_config(page_title="SCOPE", page_icon=str(Path(__file__).parent / "page" / "icon.png"), layout="wide")
_page = st.components.v2.component("scope_console", html=_INITIAL_HTML, js=_MOUNT_SCRIPT, isolate_styles=False)
_page(key="console")
