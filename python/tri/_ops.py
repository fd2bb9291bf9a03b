"""Makes functions of the operators of a registry."""

import inspect
import keyword
import types
import typing

from . import _tri

_TYPES = {"boolean": bool, "integer": int, "number": float, "choice": str, "text": str, "numbers": typing.List[float]}
_OBJECTS = {"mesh": _tri.Mesh, "soup": _tri.Soup, "points": _tri.Points}


def python_name(name):
    """fill-holes -> fill_holes; a word of the language gets an underscore."""
    name = name.replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


def default_of(option):
    value = option["default"]
    return float(value) if option["type"] == "number" and isinstance(value, (int, str)) else value


def _range(option):
    parts = []
    for key, word in (("minimum", "from"), ("above", "above"), ("maximum", "up to"), ("below", "below")):
        if key in option and abs(option[key]) < 2**31 - 1:  # beyond, it is the range of the type
            parts.append(f"{word} {option[key]:g}")
    if option.get("infinite"):
        parts.append("or inf")
    if "choices" in option:
        parts.append(" or ".join(option["choices"]))
    return " ".join(parts)


def docstring(op):
    """The text of an operator, from its schema."""
    object_name = _OBJECTS[op["domain"]].__name__
    if op["domain"] == "soup":
        object_name += " or a Mesh"
    lines = [op["summary"] + ".", "", f"Works in place on a {object_name}; returns the report as a dict."]
    if op["domain"] != "points":
        lines += ["", "selection: the part of a Mesh to keep to: a tri.Selection, or an array of faces (indices or a mask)"]
    if op["options"] and op["domain"] == "points":
        lines.append("")
    for option in op["options"]:
        said = ", ".join(part for part in (option.get("unit", ""), _range(option)) if part)
        lines.append(f"{python_name(option['name'])}: {option['help']}" + (f" ({said})" if said else ""))
    return "\n".join(lines)


def signature(op):
    """The first argument is named after what the operator works on; options are keywords."""
    kind = inspect.Parameter
    works_on = typing.Union[_tri.Soup, _tri.Mesh] if op["domain"] == "soup" else _OBJECTS[op["domain"]]
    parameters = [kind(op["domain"], kind.POSITIONAL_ONLY, annotation=works_on)]
    parameters += [kind(python_name(option["name"]), kind.KEYWORD_ONLY, default=default_of(option),
                        annotation=_TYPES[option["type"]]) for option in op["options"]]
    if op["domain"] != "points":
        parameters.append(kind("selection", kind.KEYWORD_ONLY, default=None,
                               annotation=typing.Union[_tri.Selection, typing.Sequence[int], None]))
    parameters += [kind("progress", kind.KEYWORD_ONLY, default=None,
                        annotation=typing.Optional[typing.Callable[[str, float], typing.Any]]),
                   kind("threads", kind.KEYWORD_ONLY, default=0, annotation=int)]
    return inspect.Signature(parameters, return_annotation=dict)


def _function(registry, op):
    names = {python_name(option["name"]): option["name"] for option in op["options"]}

    def call(object, /, *, selection=None, progress=None, threads=0, **options):
        unknown = [name for name in options if name not in names]
        if unknown:
            allowed = ", ".join(list(names) + ["selection", "progress", "threads"])
            raise TypeError(f"{python_name(op['name'])} has no option {unknown[0]}; allowed: {allowed}")
        given = {names[name]: value for name, value in options.items()}
        return _tri.run_operator(registry, op["name"], object, given, selection, progress, threads)

    call.__name__ = call.__qualname__ = python_name(op["name"])
    call.__module__ = "tri.ops"
    call.__doc__ = docstring(op)
    call.__signature__ = signature(op)
    return call


def operators_of(registry):
    """The operators that work in place: all but the conversions between soup and mesh."""
    return [op for op in registry.describe() if op["domain"] == op["result"]]


def functions_of(registry):
    """A namespace with a function for each operator, and the registry."""
    return types.SimpleNamespace(registry=registry,
                                 **{python_name(op["name"]): _function(registry, op) for op in operators_of(registry)})
