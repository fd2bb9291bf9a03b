"""The operators of the library by name, with the options of their schemas as keyword arguments.

    report = tri.ops.fill_holes(mesh, max_edges=50)

Each works in place on a Mesh, a Soup or Points, as its first argument is called (those on a Soup also on a Mesh), and returns a report: a dict with what was
added, removed and moved, what was left alone and why, and the indices of touched elements. "unchanged" is true if the object
is bit for bit what it was. Angles are degrees. With `selection`, an operator on a Mesh keeps to a part of it (see
tri.Selection); with `mesh.record()` or `tri.record` it can be undone.
"""

from . import _tri
from ._ops import functions_of as _functions_of

_functions = _functions_of(_tri.Registry())
globals().update({name: function for name, function in vars(_functions).items() if name != "registry"})
__all__ = sorted(name for name in vars(_functions) if name != "registry")
