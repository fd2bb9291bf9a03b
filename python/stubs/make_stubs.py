"""Writes the type stubs of tri.ops from the schemas of the operators: make_stubs.py FILE."""

import sys

import tri
from tri import _ops

_NAMES = {"boolean": "bool", "integer": "int", "number": "float", "text": "str", "numbers": "Sequence[float]"}


def _type(option):
    if option["type"] == "choice":
        return "Literal[" + ", ".join(f'"{choice}"' for choice in option["choices"]) + "]"
    return _NAMES[option["type"]]


def _default(option):
    value = _ops.default_of(option)
    if isinstance(value, float) and value in (float("inf"), float("-inf")):
        return "..."
    return repr(value) if not isinstance(value, list) else "..."


def _stub(op):
    kind = {"mesh": "Mesh", "soup": "Union[Soup, Mesh]", "points": "Points"}[op["domain"]]
    lines = [f"def {_ops.python_name(op['name'])}(", f"    {op['domain']}: {kind}, /, *,"]
    lines += [f"    {_ops.python_name(o['name'])}: {_type(o)} = {_default(o)}," for o in op["options"]]
    if op["domain"] != "points":
        lines.append("    selection: Union[Selection, ArrayLike, None] = None,")
    lines += ["    progress: Optional[Callable[[str, float], Any]] = None, threads: int = 0,", ") -> dict[str, Any]:"]
    doc = _ops.docstring(op).split("\n")
    lines += ['    """' + doc[0]] + [("    " + line).rstrip() for line in doc[1:]] + ['    """', "    ..."]
    return "\n".join(lines)


def text():
    head = ["# Made from the schemas of the operators.", "from typing import Any, Callable, Literal, Optional, Sequence, Union", "",
            "from numpy.typing import ArrayLike", "", "from . import Mesh, Points, Selection, Soup"]
    return "\n".join(head) + "\n\n" + "\n\n".join(_stub(op) for op in _ops.operators_of(tri.Registry())) + "\n"


if __name__ == "__main__":
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write(text())
