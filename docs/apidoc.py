"""The reference: entries for all public names of a module, and plain-text docstrings as reStructuredText."""

import importlib
import inspect
import re

MARKER = re.compile(r"^% public: (?P<module>[\w.]+)(?P<names>( \w+)*)$", re.M)
ITEM = re.compile(r"(?P<names>[\w`*]+(, [\w`*]+)*) : (?P<text>.*)")
HEADING = re.compile(r"-{3,}$")
INDENT = "    "


def PublicNames(module):
    """Names of a module of ngdgc that users may use: __all__, or what is defined in it or beneath it, in alphabetical order."""
    module = importlib.import_module(module)
    if hasattr(module, "__all__"):
        return sorted(module.__all__)
    return sorted(name for name, value in vars(module).items()
                  if not name.startswith("_") and (inspect.isclass(value) or inspect.isfunction(value))
                  and value.__module__.startswith(module.__name__))


def Names(text):
    """(module, name) of every entry that a page with markers will have."""
    return [(marker["module"], name) for marker in MARKER.finditer(text)
            for name in marker["names"].split() or PublicNames(marker["module"])]


def ExpandMarkers(text):
    """The page with autodoc's directives for its markers, lines `% public: MODULE` or, for some of the names, with these."""
    def Entries(marker):
        module = importlib.import_module(marker["module"])
        blocks = [_Entry(module, name) for name in marker["names"].split() or PublicNames(marker["module"])]
        return "```{eval-rst}\n" + "\n".join(blocks) + "```"
    return MARKER.sub(Entries, text)


def _Entry(module, name):
    value = getattr(module, name)
    if inspect.isclass(value):
        return f".. autoclass:: {module.__name__}.{name}\n   :members:\n"
    return f".. autofunction:: {module.__name__}.{name}\n"


def ToRst(lines):
    """Lines of reStructuredText for a docstring: formulas as typed, `name : meaning` as a list, doctests as code."""
    result = []
    for block in _Blocks(lines):
        if block[0].startswith(">>>"):
            result += [".. code-block:: pycon", "", *(INDENT + line for line in block), ""]
        elif all(line.startswith(INDENT) for line in block):
            result += ["::", "", *block, ""]
        else:
            result += _Paragraph(block)
    return result


def _Blocks(lines):
    """Runs of lines without an empty one; a formula keeps its empty lines only between blocks."""
    block = []
    for line in [*lines, ""]:
        if line.strip():
            block.append(line.rstrip())
        elif block:
            yield block
            block = []


def _Paragraph(block):
    if len(block) > 1 and HEADING.match(block[1]):
        return [f"**{block[0]}**", "", *(_Paragraph(block[2:]) if block[2:] else ())]
    result, item = [], False
    for line in block:
        found = ITEM.match(line)
        if found:
            result += [*([""] if result and not item else []), f"* {_Code(found['names'])}: {_Escape(found['text'])}"]
            item = True
        elif item and line.startswith(" "):
            result.append(f"  {_Escape(line.strip())}")
        else:
            result += [*([""] if item else []), _Escape(line.strip())]
            item = False
    return [*result, ""]


def _Code(names):
    return ", ".join(f"``{name.strip('`')}``" for name in names.split(", "))


def _Escape(text):
    """Text with `code` as literals, and nothing else that reStructuredText would read as markup."""
    parts = text.split("`")
    parts[::2] = [re.sub(r"([\\*_|])", r"\\\1", part) for part in parts[::2]]
    if len(parts) % 2 == 0:
        return re.sub(r"([\\*_|`])", r"\\\1", text)
    # A backslash ends a literal before a letter, as in a plural.
    return "".join((f"``{part}``" + ("\\ " if parts[number + 1][:1].isalnum() else "")) if number % 2 else part
                   for number, part in enumerate(parts))


def QuickReference(text):
    """The public names of a page with markers, a table for every heading of it: each name, linked, with the first sentence.

    >>> print(QuickReference("# Reference\\n\\n## Penalties\\n\\n% public: ngdgc LDG\\n").splitlines()[-1][:35])
    | {py:obj}`LDG <ngdgc.LDG>` | Local
    """
    lines, heading = [], None
    for line in text.splitlines():
        if line.startswith("## "):
            heading = [line, "", "| | |", "|---|---|"]
        for module, name in Names(line):
            lines += ["", *heading] if heading[0] not in lines else []
            sentence = FirstSentence(getattr(importlib.import_module(module), name))
            lines.append(f"| {{py:obj}}`{name} <{module}.{name}>` | {sentence} |")
    return "\n".join(lines)


def FirstSentence(value):
    """What a docstring begins with, as a cell of a table; of NGSolve's Solve, which has none, what it does here."""
    paragraph = (inspect.getdoc(value) or "Solve an equation, or a Discretization by its default solver.").split("\n\n")[0]
    # Not the points of initials.
    sentence = re.split(r"(?<!\b[A-Z])\.\s(?=[A-Z`])", " ".join(paragraph.split()))[0].rstrip(".")
    parts = sentence.split("`")
    parts[::2] = [re.sub(r"([\\*_|<>\[\]$])", r"\\\1", part) for part in parts[::2]]
    return "`".join(parts)
