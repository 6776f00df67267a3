"""Sphinx configuration: furo, executed MyST notebooks, mathematics as MathML so that the pages work offline."""

import hashlib
import os
import sys
from pathlib import Path

from sphinx.application import Sphinx

import brunovsky
from brunovsky._resources import runtime_folder

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))
# The kernels that execute the pages inherit these.
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(HERE / "_ext"), os.environ.get("PYTHONPATH"))))
os.environ["MATPLOTLIBRC"] = str(HERE / "_ext" / "matplotlibrc")
os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # silences the kernel's debugger
# Kernels that report errors only, not that they talk to this machine without encryption.
profile = HERE / "_build" / "ipython" / "profile_default"
profile.mkdir(parents=True, exist_ok=True)
(profile / "ipython_kernel_config.py").write_text("get_config().IPKernelApp.log_level = 'ERROR'\n", encoding="utf-8")
os.environ["IPYTHONDIR"] = str(profile.parent)

project = "brunovsky"
author = "the brunovsky developers"
copyright = author
version = release = brunovsky.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml"]
exclude_patterns = ["_build", "_ext", "jupyter_execute"]
default_role = "py:obj"
smartquotes_action = "D"  # dashes only: x' is a derivative

html_theme = "furo"
html_title = f"brunovsky {release}"
html_static_path = ["_static"]
html_css_files = ["pages.css"]
html_math_renderer = "mathml"
html_copy_source = False
html_show_sourcelink = False

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "force"  # what is shown is always what this version computes
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_render_markdown_format = "myst"
nb_merge_streams = True
nb_output_stderr = "warn"  # a page that executes with warnings is not finished

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings name types, shapes and units
autodoc_default_options = {"members": True, "exclude-members": "model_config"}
napoleon_google_docstring = False
napoleon_use_param = False  # types are words, not cross-references
napoleon_custom_sections = [("Attributes", "params_style")]
napoleon_use_rtype = False


def setup(app: Sphinx) -> None:
    """Execute all pages again when the package has changed, not only those whose text has."""
    sources = [*Path(brunovsky.__file__).parent.rglob("*.py"), *runtime_folder().glob("*.[ch]"), *HERE.glob("_ext/*")]
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(sources) if path.is_file())).hexdigest()
    app.add_config_value("package_digest", digest, "env", str)
