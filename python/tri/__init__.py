"""Triangle meshes from CAD models, measured points and broken files.

Meshes are `Mesh` (half-edges, what most operators work on) and `Soup` (triangles of any topology, as files have them),
measured points are `Points`; their arrays look into them without a copy where a comment says so. An array shows the object
as it was when it was asked for: after an operator has run, ask again.

Work that takes long releases Python's lock, takes `progress`, a function of (step, share done) that may raise, and stops at
Ctrl-C; both end the work and leave the object valid.
"""

import json as _json
from typing import Any, NamedTuple, Optional

from . import _tri, ops
from ._ops import functions_of as _functions_of
from ._ops import python_name as _python_name
from ._tri import (CadError, Cancelled, Change, ChangeNotes, ElementNotes, Error, InvalidInput, IoError, Mesh, Points, Registry,
                   Selection, Soup, __version__, check, mesh_distance, read_points, read_soup, repair, write)

__all__ = ["CadError", "Cancelled", "Change", "ChangeNotes", "ElementNotes", "Error", "InvalidInput", "IoError", "Mesh", "Points",
           "Registry", "Selection", "Soup", "check", "dry_run", "load_plugins", "mesh_distance", "ops", "read_mesh", "read_points",
           "read_soup", "record", "repair", "run", "write"]


def read_mesh(path, *, progress=None, threads=0):
    """Reads STL, OBJ, PLY or OFF as a Mesh; its build_report says what had to be oriented and split."""
    return read_soup(path, progress=progress, threads=threads).to_mesh()


def run(object, steps, *, progress=None, threads=0, registry=None):
    """Runs operators one after another on a copy of a Mesh, Soup or Points; conversions between mesh and soup are inserted.

    steps: a recipe as `tri run --save` writes it (text or dict), or a list of names and (name, options) pairs:
    ["weld", ("fill-holes", {"max_edges": 50}), "compact"]. Returns what came out and a list with a report for each step.
    """
    if isinstance(steps, str):
        recipe = steps
    elif isinstance(steps, dict):
        recipe = _json.dumps(steps)
    else:
        pairs = [(step, {}) if isinstance(step, str) else step for step in steps]
        recipe = _json.dumps({"version": 1, "steps": [
            {"op": name.replace("_", "-"), **{key.replace("_", "-"): _plain(value) for key, value in options.items()}}
            for name, options in pairs]})
    return _tri.run_recipe(registry or _tri.Registry(), object, recipe, progress, threads)


def record(mesh, operator, /, **options):
    """Runs an operator on a Mesh and returns what it did as a Change, which can be undone and done again.

    operator: its name, or a function of a mesh: one of `tri.ops` or of `load_plugins`, or your own, which may run several.
    options: handed to it. If it raises, the mesh is as it was.
    """
    if isinstance(operator, str):
        name = _python_name(operator)
        if name not in ops.__all__:
            raise InvalidInput(f"unknown operator '{operator}'; known: {', '.join(ops.__all__)}")
        function = getattr(ops, name)
    else:
        function = operator
    with mesh.record() as change:
        function(mesh, **options)
    return change


def dry_run(mesh, operator, /, **options):
    """What an operator would do to a Mesh: runs it as `record` does and takes it back. The Change that is returned is undone
    already; its notes and reports are what one is after, and `redo` does it without computing it again."""
    change = record(mesh, operator, **options)
    change.undo()
    return change


def _plain(value):
    if isinstance(value, float) and value in (float("inf"), float("-inf")):
        return "inf" if value > 0 else "-inf"
    return value


def load_plugins(*folders):
    """The operators of the library and of the plug-ins (*.so) in these folders, as `tri.ops` has those of the library.

    The object that is returned keeps the plug-ins loaded; `tri.ops` does not change. Its attribute `registry` is what `run`
    takes.
    """
    registry = _tri.Registry()
    registry.load_plugins([str(folder) for folder in folders])
    return _functions_of(registry)


if hasattr(_tri, "Model"):
    from ._tri import Model, example_part, example_parts, measure, read_cad, register, write_cad

    __all__ += ["Alignment", "Comparison", "Model", "Triangulation", "align", "compare", "example_part", "example_parts",
                "measure", "read_cad", "register", "triangulate", "write_cad"]

    class Triangulation(NamedTuple):
        """What `triangulate` made."""
        mesh: Mesh  #: vertex properties point_index, cad_face, uv, deviation
        report: dict  #: as `tri triangulate --report` writes it
        patches: Optional[Mesh]  #: before stitching, when asked for
        alignment: Optional[dict]  #: report of `align`, when points were aligned

    class Alignment(NamedTuple):
        """What `align` found."""
        points: Points  #: moved onto the model
        pose: Any  #: (4, 4) float64, takes the points to the model
        report: dict  #: status is "good", "ambiguous" or "failed"

    class Comparison(NamedTuple):
        """How points deviate from a model."""
        values: Any  #: (n,) float64, mm, positive outside
        faces: Any  #: (n,) int32, 1-based
        report: dict  #: overall, faces, far, worst

    def triangulate(model, points, *, method="auto", unmeasured="hole", hole_size=3.0, outlier_distance=None, patches=False,
                    align="none", seed=1, progress=None, threads=0):
        """One mesh through points measured on a model, as a Triangulation.

        points: Points, or an array (n, 3), in mm. method: auto, patches or shell. unmeasured: hole leaves regions without
        points open, span closes them. hole_size: in local point spacings. outlier_distance: mm. align: none takes the points
        as they lie, auto and icp move them first (see `align`); points that do not fit are then an Error.
        """
        alignment = None
        if align != "none":
            moved = globals()["align"](model, points, mode=align, seed=seed, progress=progress, threads=threads)
            alignment = moved.report
            if alignment["status"] == "failed":
                raise Error("; ".join(alignment["reasons"]))
            points = moved.points
        mesh, report, before = _tri.triangulate_points(model, points, method, unmeasured, hole_size, outlier_distance, patches,
                                                       progress, threads)
        return Triangulation(mesh, report, before, alignment)

    def align(model, points, *, mode="auto", start=None, metric="plane", keep=1.0, probe_radius=0.0, seed=1, progress=None,
              threads=0):
        """The rigid motion that takes points to a model, as an Alignment.

        mode: auto searches the pose from nothing unless the points lie on the model already; icp refines from `start` (a 4x4
        matrix) or from where they are; none only measures. keep: share of the points that count. probe_radius: mm, of the
        ball whose centres were measured. Points that do not fit are no exception: report["status"] says so.
        """
        return Alignment(*_tri.align_points(model, points, mode, start, metric, keep, probe_radius, seed, progress, threads))

    def compare(model, points, *, tolerance=None, max_distance=None, spots=10, progress=None, threads=0):
        """The signed deviation of points from a model, as a Comparison.

        tolerance: (low, high) in mm. max_distance: mm, points beyond it are listed and not counted. spots: how many of the
        worst places are named.
        """
        return Comparison(*_tri.compare_points(model, points, tolerance, max_distance, spots, progress, threads))
