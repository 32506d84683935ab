"""Makes pages of the source tree part of the book: the laws' and modules' `doc.md`, which rustdoc shows as well.

- Links to items of Rust become code; fences without a language are Rust, as in rustdoc, and lines that rustdoc hides go.
- A link to a file outside of the book leads to the page that includes this file; on that page, or if no page does, it is its path. A
  file that is not there is a warning.
- Files of tutorials show their names.
- Pictures are loaded when they come into sight.
- A letter with an index, `D_t` or `η_{n+1}`, is typeset in running text too.
"""

import re
from pathlib import Path

from sphinx.util import logging

LOG = logging.getLogger(__name__)
ROOT = Path(__file__).parent.parent.parent
BOOK = ROOT / "docs"
RUST_ITEM = re.compile(r"\[(`[^`\]]+`)\](?![(\[:])")
# where the book speaks of what rustdoc links to
PAGES_OF_ITEMS = {
    "`crate::damage_law`": "[what the laws share](/theory/common.md)",
    "`crate::kinematics`": "[small strains](/theory/kinematics.md)",
    "`super`": "[concrete damage](/theory/laws/concrete_damage.md)",
    "`calibration`": "[Calibration](/theory/calibration.md)",
}
HIDDEN = re.compile(r"^# .*(Ok::|use |fn ).*$\n?", re.MULTILINE)
INCLUDE = re.compile(r"^```\{include\} (\S+)", re.MULTILINE)
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
# what is code, a formula, a heading's anchor or a comment stays as it is
FENCE = re.compile(r"^(?P<fence>```+|:::+)(?P<info>[^\n]*)\n(?P<code>.*?)^(?P=fence)$", re.MULTILINE | re.DOTALL)
KEPT = re.compile(r"(`[^`]+`|\$[^$\n]+\$|<!--.*?-->|\]\([^)]*\))", re.DOTALL)
# a tutorial's file, which the tests write as well
FILE = re.compile(r"^<!-- file: (\S+) -->\n```(\w+)\n", re.MULTILINE)
INDEXED = re.compile(r"(?<![\w.$])([A-Za-zα-ωΑ-Ω][̀-ͯ]?[ᵉᵖ]?_(?:\{[^}]*\}|[A-Za-z0-9α-ω]{1,6}(?:,[a-z]{1,5})?)'?)(?![A-Za-z0-9_])")


def pages():
    """The page of each included file."""
    found = {}
    for page in BOOK.rglob("*.md"):
        if "_build" in page.parts or ".venv" in page.parts:
            continue
        found[page.resolve()] = page
        for name in INCLUDE.findall(page.read_text()):
            found.setdefault((page.parent / name).resolve(), page)
    return found


PAGES = pages()


def linked(match, folder, page):
    """A link as the book has it, from `page`, which may include a file of another folder."""
    image, text, target = match.groups()
    path, _, anchor = target.partition("#")
    # a picture, also one that is a link
    if image or text.startswith("![") or not path or "://" in path or path.startswith("mailto:") or path.endswith(".html"):
        return match.group()
    file = (folder / path).resolve()
    if not file.exists():
        LOG.warning("no such file: %s", target, location=str(page.relative_to(BOOK).with_suffix("")))
        return match.group()
    if PAGES.get(file) == page:
        # the file that this page shows
        return f"`{file.relative_to(ROOT)}`"
    if file in PAGES:
        book = Path("/") / PAGES[file].relative_to(BOOK)
        return f"[{text}]({book}{'#' + anchor if anchor else ''})"
    path = f"`{file.relative_to(ROOT)}{'/' if file.is_dir() else ''}`"
    return path if text.strip("`") in target else f"{text} ({path})"


def prose(text, folder, page):
    text = LINK.sub(lambda match: linked(match, folder, page), text)
    text = RUST_ITEM.sub(lambda match: PAGES_OF_ITEMS.get(match[1], match[1]), text)
    pieces = KEPT.split(text)
    pieces[::2] = [INDEXED.sub(r"$\1$", piece) for piece in pieces[::2]]
    return "".join(pieces)


def converted(text, folder, page):
    text = FILE.sub(r"```{code-block} \2\n:caption: \1\n\n", text)
    out, at = "", 0
    for match in FENCE.finditer(text):
        out += prose(text[at : match.start()], folder, page)
        info, code = match["info"].strip(), match["code"]
        if info in ("", "rust", "no_run"):
            out += "```rust\n" + HIDDEN.sub("", code) + "```"
        else:
            out += match.group()
        at = match.end()
    return out + prose(text[at:], folder, page)


def read_page(app, docname, source):
    page = BOOK / f"{docname}.md"
    source[0] = converted(source[0], page.parent, page)


def read_included(app, path, docname, content):
    file = (BOOK / path).resolve()
    if file.suffix == ".md":
        content[0] = converted(content[0], file.parent, BOOK / f"{docname}.md")


def load_lazily(app, page, template, context, tree):
    """Pictures are loaded when they come into sight."""
    if "body" in context:
        context["body"] = context["body"].replace("<img ", '<img loading="lazy" ')


def setup(app):
    app.connect("source-read", read_page)
    app.connect("include-read", read_included)
    app.connect("html-page-context", load_lazily)
    return {"parallel_read_safe": True}
