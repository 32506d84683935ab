"""Typesets formulas, written as plain text, with KaTeX while the book is built.

The tree has one notation for formulas, in the laws' pages and in the book: Unicode text that reads in an editor and in
rustdoc, in a fence `formula` (not `math`, which some readers of Markdown take for TeX) or between dollars.

    σ = (1 − D) K₀ : ε        (4.15)

- A line is an equation; its first relation is aligned with those of the other lines, and what stands in parentheses at its
  end, after two spaces or more, is its number in the thesis. Two spaces or more elsewhere set formulas apart.
- `a/(b + c)` without spaces about the slash is a fraction where the formula stands on a line of its own.
- `x_trial`, `x_{n+1}`, `x^B`, `x^(1/B)`, `√(a + b)`, `⟨x⟩`, `∑`, `½`, accents and Unicode's raised and lowered signs.
- Words of three letters or more are words, or functions (`max`, `tr`, `exp`).

A formula with a backslash is TeX already. What KaTeX cannot read is a warning at its place.
"""

import re
from html import escape
from pathlib import Path

from docutils import nodes
from py_mini_racer import MiniRacer
from sphinx.directives.patches import MathDirective
from sphinx.util import logging

LOG = logging.getLogger(__name__)
KATEX = Path(__file__).parent.parent / "_static" / "katex" / "katex.min.js"

FUNCTIONS = {
    *("sin", "cos", "tan", "cosh", "sinh", "tanh", "exp", "ln", "max", "min", "det", "arg"),
    *("tr", "sign", "clip", "dev", "sym", "skew", "mean", "smoothstep"),
}
KNOWN_TO_TEX = {"sin", "cos", "tan", "cosh", "sinh", "tanh", "exp", "ln", "max", "min", "det", "arg"}
SHORT_WORDS = {"if", "of", "or", "on", "at", "in", "is", "no", "to", "by", "as"}
RAISED = dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻⁽⁾ᵀᵉᵖⁿ", "0123456789+-()Tepn"))
LOWERED = dict(zip("₀₁₂₃₄₅₆₇₈₉₊₋ₙ", "0123456789+-n"))
PARTS = {"½": r"\tfrac12", "⅓": r"\tfrac13", "⅔": r"\tfrac23", "¼": r"\tfrac14", "¾": r"\tfrac34"}
OPENING = {"(": "(", "[": "[", "{": r"\{", "⟨": r"\langle "}
CLOSING = {")": ")", "]": "]", "}": r"\}", "⟩": r"\rangle "}
OPERATORS = set("+−-=<>≤≥≠≈→≡∈·×,;±∝|∓")
RELATIONS = set("=<>≤≥≠≈→≡∈∝")
SIGNS = {
    "−": "-", "-": "-", ":": r"\mathbin{:}", "…": r"\ldots ", "°": r"^\circ ", "%": r"\% ", "#": r"\# ", "&": r"\& ",
    "·": r"\cdot ", "→": r"\to ", "≤": r"\le ", "≥": r"\ge ", "≠": r"\ne ", "≈": r"\approx ", "∑": r"\sum ", "∫": r"\int ",
}  # fmt: skip
NUMBER_IN_THESIS = re.compile(r"\s{2,}\(([^()]*\d\.\d+[^()]*|[^()]*§[^()]*)\)\s*$")
WORD = re.compile(r"[A-Za-z]+(-[a-z]+)*")
LOW = re.compile(r"_(\{[^}]*\}|[A-Za-z0-9α-ω]+(,[A-Za-z0-9]+)*)")
HIGH = re.compile(r"\^(\{[^}]*\}|[A-Za-z0-9*]+)")
FACTOR_OF_TEN = re.compile(r"(\d+(?:\.\d+)?)e(-?\d+)")
COMBINING = re.compile("[̀-ͯ]+")


class Item:
    """A factor, an operator or words, with what hangs on it."""

    def __init__(self, tex, kind, space):
        self.tex, self.kind, self.space, self.scripts = tex, kind, space, ""

    def whole(self):
        return self.tex + self.scripts


def lowered(text):
    """An index: signs in italics, words upright."""
    if text.startswith("{"):
        return plain(text[1:-1], False)
    if len(text) > 1 and any(c.isalpha() for c in text) and (
        text in ("in", "pl") or not set(text) <= set("abijklmnpqsuxyz0123456789,")
    ):
        return r"\mathrm{" + text + "}"
    return text


class Reader:
    def __init__(self, text, display):
        self.text, self.at, self.display = text, 0, display

    def items(self, closing=None):
        """What stands up to the closing bracket."""
        found = []
        space = False
        while self.at < len(self.text):
            c = self.text[self.at]
            if c in CLOSING:
                if closing is not None:
                    return found
                found.append(self.take(1, CLOSING[c], "operator", space))
            elif c.isspace():
                run = re.match(r"\s+", self.text[self.at :]).group()
                self.at += len(run)
                space = True
                if len(run) > 1 and closing is None:
                    found.append(Item(r"\qquad ", "operator", True))
                continue
            else:
                item = self.item(c, space)
                if item is None:
                    # belongs to what stands before it
                    last = found[-1] if found else Item("{}", "factor", space)
                    if not found:
                        found.append(last)
                    last.scripts += self.script()
                else:
                    found.append(item)
            space = False
        return found

    def take(self, length, tex, kind, space):
        self.at += length
        return Item(tex, kind, space)

    def script(self):
        rest = self.text[self.at :]
        if match := LOW.match(rest):
            self.at += match.end()
            return "_{" + lowered(match.group(1)) + "}"
        if rest.startswith("^("):
            self.at += 2
            display, self.display = self.display, False
            inner = self.group("(")
            self.display = display
            return "^{" + inner + "}"
        if match := HIGH.match(rest):
            self.at += match.end()
            text = match.group(1)
            return "^{" + (plain(text[1:-1], False) if text.startswith("{") else text) + "}"
        for table, sign in ((RAISED, "^"), (LOWERED, "_")):
            length = 0
            while length < len(rest) and rest[length] in table:
                length += 1
            if length:
                self.at += length
                return sign + "{" + "".join(table[c] for c in rest[:length]) + "}"
        if rest[0] == "*":
            self.at += 1
            return "^{*}"
        length = len(rest) - len(rest.lstrip("'′"))
        if length == 0:
            # an index or a power of nothing that can be one: KaTeX says so
            self.at += 1
            return rest[0]
        self.at += length
        return "^{" + r"\prime" * length + "}"

    def group(self, opening):
        """The inside of a bracket, up to and with its end."""
        inner = joined(self.items(opening), self.display)
        self.closed = self.text[self.at] if self.at < len(self.text) else ")"
        self.at += 1
        return inner

    def item(self, c, space):
        rest = self.text[self.at :]
        if c in "_^'′*" or c in RAISED or c in LOWERED:
            return None
        if c in OPENING:
            self.at += 1
            inner = self.group(c)
            size = (r"\left", r"\right") if r"\frac" in inner or r"\sum" in inner else ("", "")
            item = Item(size[0] + OPENING[c] + inner + size[1] + CLOSING[self.closed], "group", space)
            item.inner = inner if c == "(" else None
            return item
        if c == "√":
            self.at += 1
            if self.text[self.at] == "(":
                self.at += 1
                return Item(r"\sqrt{" + self.group("(") + "}", "factor", space)
            under = self.item(self.text[self.at], False)
            while self.at < len(self.text) and (self.text[self.at] in "_^" or self.text[self.at] in LOWERED):
                under.scripts += self.script()
            return Item(r"\sqrt{" + under.whole() + "}", "factor", space)
        if match := FACTOR_OF_TEN.match(rest):
            ten = "10^{" + match.group(2) + "}"
            one = match.group(1)
            return self.take(match.end(), ten if one == "1" else one + r"\cdot " + ten, "factor", space)
        if match := re.match(r"\d+(\.\d+)?", rest):
            return self.take(match.end(), match.group(), "factor", space)
        if match := WORD.match(rest):
            word = match.group()
            following = rest[match.end() :]
            if word in FUNCTIONS:
                tex = "\\" + word + " " if word in KNOWN_TO_TEX else r"\operatorname{" + word + "}"
                return self.take(len(word), tex, "function", space)
            is_lone = not following[:1] or following[0] in " ,;.)"
            if (len(word) > 2 and word not in ("EIw",)) or (word in SHORT_WORDS and is_lone and space):
                return self.take(len(word), word, "words", space)
        tex, length = (PARTS.get(c) or SIGNS.get(c) or c), 1
        if match := COMBINING.match(rest[1:]):
            accents = {"̄": r"\bar", "̂": r"\hat", "̃": r"\tilde", "̇": r"\dot"}
            for accent in match.group():
                tex = accents[accent] + "{" + tex + "}"
            length += match.end()
        elif c in "ᾱ":
            tex = r"\bar{α}"
        kind = "slash" if c == "/" else "operator" if c in OPERATORS or c == ":" else "factor"
        return self.take(length, tex, kind, space)


def joined(items, display):
    """The TeX of a row of items, with fractions where slashes bind."""
    done = []
    at = 0
    while at < len(items):
        item = items[at]
        if item.kind == "slash" and display and done and not item.space and at + 1 < len(items) and not items[at + 1].space:
            above = []
            while done and done[-1].kind in ("factor", "group", "fraction"):
                above.insert(0, done.pop())
                if above[0].space:
                    break
            if above and above[0].space and done and done[-1].kind == "function":
                above.insert(0, done.pop())
            below = [items[at + 1]]
            at += 2
            while below[0].kind != "group" and at < len(items) and not items[at].space and items[at].kind in ("factor", "group"):
                below.append(items[at])
                at += 1
            fraction = Item(r"\frac{" + bare(above) + "}{" + bare(below) + "}", "fraction", above[0].space if above else False)
            done.append(fraction)
            continue
        done.append(item)
        at += 1
    out = ""
    words = []
    for at, item in enumerate(done):
        # a comma or a colon between words is the words'
        is_between = words and item.tex in (",", SIGNS[":"]) and done[at + 1 : at + 2] and done[at + 1].kind == "words"
        if is_between:
            words[-1].tex += "," if item.tex == "," else ":"
            continue
        if item.kind == "words":
            words.append(item)
            continue
        out += text_of(words)
        words = []
        out += item.whole() + ("" if item.tex.endswith((" ", "}")) else " ")
    return out + text_of(words)


def text_of(words):
    return r"\;\text{" + " ".join(w.tex for w in words) + r"}\;" + "".join(w.scripts for w in words) if words else ""


def bare(items):
    """Numerator or denominator: a lone bracket needs no bracket."""
    if len(items) == 1 and getattr(items[0], "inner", None) is not None and not items[0].scripts:
        return items[0].inner
    return "".join(item.whole() for item in items)


def plain(text, display):
    return joined(Reader(text, display).items(), display)


def equation(line):
    """One line of a display: left side & the rest && number."""
    number = ""
    if match := NUMBER_IN_THESIS.search(line):
        number = r"&&\text{(" + match.group(1) + ")}"
        line = line[: match.start()]
    line = line.rstrip()
    depth = 0
    for place, c in enumerate(line):
        depth += (c in OPENING) - (c in CLOSING)
        if depth == 0 and c in RELATIONS:
            return plain(line[:place].strip(), True) + "{}&" + plain(line[place:].strip(), True) + number
    return "&" + plain(line.strip(), True) + number


def tex(text, display):
    """The TeX of a formula in the tree's notation."""
    text = text.strip("\n")
    if "\\" in text:
        return text
    if not display:
        return plain(" ".join(text.split()), False)
    lines = [line for line in text.splitlines() if line.strip()]
    return r"\begin{aligned}" + r"\\".join(equation(line) for line in lines) + r"\end{aligned}"


class Katex:
    """KaTeX in an engine of its own, loaded once."""

    def __init__(self):
        self.engine = MiniRacer()
        self.engine.eval(KATEX.read_text())

    def html(self, source, display, place):
        try:
            options = {"displayMode": display, "throwOnError": True, "strict": "ignore", "output": "html"}
            return self.engine.call("katex.renderToString", source, options)
        except Exception as error:
            told = str(error).splitlines()[0]
            LOG.warning("formula: %s in %s", told, source, location=place)
            return escape(source)


_KATEX = None


def html(node, display):
    global _KATEX
    if _KATEX is None:
        _KATEX = Katex()
    source = tex(node.astext(), display)
    return _KATEX.html(source, display, node)


def visit_math(self, node):
    self.body.append(f'<span class="math">{html(node, False)}</span>')
    raise nodes.SkipNode


def visit_displaymath(self, node):
    self.body.append(f'<div class="math">{html(node, True)}</div>')
    raise nodes.SkipNode


def setup(app):
    app.add_directive("formula", MathDirective)
    app.add_html_math_renderer("katex", (visit_math, None), (visit_displaymath, None))
    app.add_css_file("katex/katex.min.css")
    return {"parallel_read_safe": True, "parallel_write_safe": False}
