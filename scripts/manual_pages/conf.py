"""Sphinx: how the Markdown files of the source tree become one manual. `build.py` stages them and calls it."""
import os

from pygments.lexers.special import TextLexer

project = "WEMS"
author = "The WEMS developers"
version = release = os.environ.get("WEMS_VERSION", "")
html_title = f"WEMS {version}".strip()

extensions = ["myst_parser"]
myst_heading_anchors = 4
source_suffix = {".md": "markdown"}
root_doc = "README"

html_theme = "furo"
smartquotes = False  # they would join the dashes of options
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
html_css_files = ["manual.css"]
html_static_path = ["static"]

# What stands in the margin, in reading order. A page that is named nowhere is a warning, and a warning ends the build.
CONTENTS = {
    "User guide": [
        "identify/TUTORIAL",
        "models/GALLERY",
        "scripts/manual_pages/own_mount",
        "scripts/manual_pages/shaker_table",
        "scripts/manual_pages/shaker_week",
        "scripts/manual_pages/sensors",
        "scripts/manual_pages/symptoms",
    ],
    "Method": [
        "identify/README",
        "scripts/manual_pages/laws",
        "identify/diagnose/README",
        "identify/component/README",
        "scripts/manual_pages/comparison",
    ],
    "Reference": [
        "scripts/manual_pages/commands",
        "models/README",
        "models/recording/README",
        "identify/python/README",
        "identify/matlab/README",
        "plugin/README",
        "scripts/manual_pages/names",
        "scripts/manual_pages/result_files",
        "scripts/manual_pages/units",
        "scripts/manual_pages/glossary",
    ],
    "Validation": [
        "identify/VALIDATION",
        "scripts/README",
        "identify/paper/README",
        "tests/recording/data/README",
    ],
    "Project": ["CONTRIBUTING", "tests/README", "DEPENDENCIES"],
}


def add_contents(app, docname, source):
    """The front page is the README, which is read elsewhere too: its table of contents is added here."""
    if docname == root_doc:
        source[0] += "".join(
            "\n\n```{toctree}\n:hidden:\n:caption: " + caption + "\n\n" + "\n".join(pages) + "\n```\n"
            for caption, pages in CONTENTS.items())


def setup(app):
    app.connect("source-read", add_contents)
    app.add_lexer("usage", TextLexer)  # a language of the documents' tests
