"""Tests of selections, recorded changes and properties of the module tri. Oracles are numpy and the mesh's own arrays before."""

import gc
import tempfile
import unittest

import numpy as np

import tri
from test_tri import CUBE, CUBE_POINTS, grid


def state(mesh):
    """All that arrays show of a mesh, copied."""
    properties = {**{"v:" + k: v.copy() for k, v in mesh.vertex_properties.items()},
                  **{"f:" + k: v.copy() for k, v in mesh.face_properties.items()}}
    return [mesh.points.copy(), mesh.faces, mesh.halfedges, mesh.face_indices, mesh.deleted_vertices, mesh.deleted_faces, properties]


def rough(n=8, hole=()):
    """A sheet with noise in its heights, which smoothing moves."""
    points, triangles = grid(n, hole)
    points[:, 2] += np.random.default_rng(3).normal(0, 0.1, len(points))
    return tri.Mesh(points, triangles)


class Same:
    def assertSame(self, a, b):
        for x, y in zip(a[:-1], b[:-1]):
            self.assertEqual(x.shape, y.shape)
            self.assertEqual(x.tobytes(), y.tobytes())
        self.assertEqual({k: v.tobytes() for k, v in a[-1].items()}, {k: v.tobytes() for k, v in b[-1].items()})


class Selections(Same, unittest.TestCase):
    def moved(self, mesh, before):
        return set(np.flatnonzero((mesh.points != before).any(axis=1)))

    def test_vertices_by_index_and_by_mask(self):
        chosen = [30, 31, 40, 41]  # inside a sheet of 9 x 9
        by_index, by_mask = rough(), rough()
        before = by_index.points.copy()
        tri.ops.smooth(by_index, selection=tri.Selection(vertices=chosen))
        self.assertEqual(self.moved(by_index, before), set(chosen))
        tri.ops.smooth(by_mask, selection=tri.Selection(vertices=np.isin(np.arange(81), chosen)))
        self.assertTrue((by_mask.points == by_index.points).all())

    def test_faces_move_the_vertices_that_have_no_other_face(self):
        mesh = rough()
        before = mesh.points.copy()
        faces = np.flatnonzero((mesh.points[mesh.faces][:, :, 0] <= 4).all(axis=1))
        others = np.setdiff1d(np.arange(len(mesh.faces)), faces)
        allowed = set(mesh.faces[faces].ravel()) - set(mesh.faces[others].ravel())
        plain = rough()
        tri.ops.smooth(plain, selection=faces)
        tri.ops.smooth(mesh, selection=tri.Selection(faces=faces))
        self.assertTrue((plain.points == mesh.points).all())
        self.assertTrue(self.moved(mesh, before))
        self.assertLessEqual(self.moved(mesh, before), allowed)

    def test_loops_are_filled_and_others_are_not(self):
        mesh = tri.Mesh(*grid(9, hole={(2, 2), (6, 6)}))
        loops = mesh.boundary_loops
        self.assertEqual(sorted(len(loop) for loop in loops), [4, 4, 36])
        corners = [set(mesh.halfedges[loop].ravel()) for loop in loops]
        wanted = next(i for i, c in enumerate(corners) if c == {22, 23, 32, 33})
        report = tri.ops.fill_holes(mesh, selection=tri.Selection(loops=loops[wanted][:1]))
        self.assertEqual(report["faces_added"], 2)
        self.assertEqual(sorted(len(loop) for loop in mesh.boundary_loops), [4, 36])

    def test_an_empty_selection_changes_nothing(self):
        mesh = rough()
        before = state(mesh)
        for selection in ([], np.zeros(len(mesh.faces), bool), tri.Selection(vertices=[]), tri.Selection(loops=[])):
            self.assertTrue(tri.ops.smooth(mesh, selection=selection)["unchanged"])
        self.assertSame(before, state(mesh))

    def test_a_mask_passes_over_what_is_deleted_and_an_index_does_not(self):
        mesh = tri.Mesh(np.vstack([CUBE_POINTS, CUBE_POINTS * 0.01 + 5]), np.vstack([CUBE, CUBE[:2] + 8]))
        tri.ops.remove_components(mesh, min_triangles=5)
        self.assertEqual(mesh.deleted_faces.tolist(), [12, 13])
        self.assertEqual(mesh.face_indices.tolist(), list(range(12)))
        tri.ops.flip_diagonals(mesh, selection=np.ones(14, bool))
        with self.assertRaisesRegex(tri.InvalidInput, "face 13 is deleted"):
            tri.ops.flip_diagonals(mesh, selection=[3, 13])

    def test_what_is_no_selection_is_refused_and_nothing_changes(self):
        mesh = rough(hole={(3, 3)})
        before = state(mesh)
        for selection, message in [([9999], "9999 is not of this mesh"), ([-1], "-1 is not of this mesh"),
                                   ([0.5], "indices or bools"), ([[1, 2]], r"shape \(n,\)"), ("text", "indices or bools"),
                                   (np.ones(5, bool), "the mask has 5 entries, and the mesh 126 faces"),
                                   (tri.Selection(loops=[0]), "has a face")]:
            with self.subTest(selection=selection), self.assertRaisesRegex(tri.InvalidInput, message):
                tri.ops.smooth(mesh, selection=selection)
        for arguments in ({}, {"faces": [1], "vertices": [1]}):
            with self.assertRaises(tri.InvalidInput):
                tri.Selection(**arguments)
        with self.assertRaisesRegex(tri.InvalidInput, "compact takes no selection"):
            tri.ops.compact(mesh, selection=[1])
        with self.assertRaisesRegex(tri.InvalidInput, "a selection is of a Mesh"):
            tri.ops.weld(tri.Soup(*grid(2)), selection=[1])
        self.assertSame(before, state(mesh))

    def test_operators_on_soups_keep_to_a_selection_of_a_mesh(self):
        points = np.vstack([CUBE_POINTS[CUBE].reshape(-1, 3), CUBE_POINTS[CUBE].reshape(-1, 3) + 5])
        mesh = tri.Mesh(points, np.arange(72).reshape(-1, 3))
        tri.ops.weld(mesh, selection=np.arange(12))
        used = [len(np.unique(mesh.faces[(mesh.points[mesh.faces][:, 0, 0] > 3) == far])) for far in (False, True)]
        self.assertEqual(used, [8, 36])


class Changes(Same, unittest.TestCase):
    def test_undo_and_redo_restore_every_bit(self):
        mesh = rough(hole={(2, 3)})
        before = state(mesh)
        with mesh.record() as change:
            tri.ops.fill_holes(mesh)
            tri.ops.smooth(mesh, iterations=2)
            tri.ops.decimate(mesh, faces=60)
        after = state(mesh)
        self.assertEqual([r["operation"] for r in change.reports], ["fill-holes", "smooth", "decimate"])
        for _ in range(2):
            self.assertFalse(change.undone)
            change.undo()
            self.assertTrue(change.undone)
            self.assertSame(before, state(mesh))
            change.redo()
            self.assertSame(after, state(mesh))

    def test_arrays_keep_what_they_showed_and_do_not_hinder_an_undo(self):
        mesh = rough()
        first = mesh.points
        before = first.copy()
        change = tri.record(mesh, "smooth")
        second = mesh.points
        after = second.copy()
        self.assertTrue((first == before).all())
        change.undo()
        self.assertTrue((mesh.points == before).all())
        self.assertTrue((first == before).all() and (second == after).all())
        third = mesh.points
        change.redo()
        self.assertTrue((mesh.points == after).all())
        self.assertTrue((third == before).all())
        mesh.points[0] = 7
        self.assertEqual(first[0].tolist(), before[0].tolist())
        del mesh
        gc.collect()
        self.assertTrue((first == before).all() and (second == after).all())

    def test_compact_is_undone_as_well(self):
        mesh = tri.Mesh(np.vstack([CUBE_POINTS, CUBE_POINTS + 5]), np.vstack([CUBE[:2], CUBE + 8]))
        before = state(mesh)
        with mesh.record() as change:
            tri.ops.remove_components(mesh, min_triangles=5)
            tri.ops.compact(mesh)
        self.assertEqual(len(mesh.points), 12)  # four points had no face from the beginning
        self.assertTrue(change.notes.renumbered)
        change.undo()
        self.assertSame(before, state(mesh))
        change.redo()
        self.assertEqual(len(mesh.points), 12)

    def test_notes_say_what_was_added_removed_and_moved(self):
        mesh = rough(hole={(2, 3)})
        before = mesh.points.copy()
        faces = len(mesh.faces)
        change = tri.record(mesh, tri.ops.smooth)
        moved = np.flatnonzero((mesh.points != before).any(axis=1))
        self.assertEqual(change.notes.vertices_moved.tolist(), moved.tolist())
        change = tri.record(mesh, "fill-holes", max_edges=8)
        self.assertEqual(change.notes.faces.added.tolist(), [faces, faces + 1])
        self.assertEqual(change.notes.inverse().faces.removed.tolist(), [faces, faces + 1])
        self.assertEqual(len(change.notes.vertices.added), 0)
        self.assertFalse(change.notes.renumbered)

    def test_notes_of_several_operators_are_those_of_the_whole(self):
        points, triangles = grid(8, hole={(2, 3)})
        mesh = tri.Mesh(np.vstack([points, CUBE_POINTS + [0, 0, 20]]), np.vstack([triangles, CUBE[:5] + len(points)]))
        faces, vertices, live, before = len(mesh.faces), len(mesh.points), set(mesh.face_indices), mesh.points.copy()
        with mesh.record() as change:
            tri.ops.fill_holes(mesh, max_edges=8)            # closes the cube, too
            tri.ops.smooth(mesh)                             # moves its corners
            tri.ops.remove_components(mesh, min_triangles=50)    # and takes all of it away
        notes = change.notes
        now = set(mesh.face_indices)
        self.assertEqual(set(notes.faces.added), now - live)
        self.assertEqual(set(notes.faces.removed), live - now)
        self.assertTrue((notes.faces.added >= faces).all())
        self.assertEqual(set(notes.vertices.removed), set(mesh.deleted_vertices) - {v for v in mesh.deleted_vertices if v >= vertices})
        moved = {i for i in range(vertices) if (mesh.points[i] != before[i]).any()} - set(mesh.deleted_vertices)
        self.assertEqual(set(notes.vertices_moved), moved)

    def test_a_dry_run_leaves_the_mesh_and_says_what_would_be(self):
        mesh = rough(hole={(2, 3)})
        before = state(mesh)
        change = tri.dry_run(mesh, "fill_holes", max_edges=8)
        self.assertTrue(change.undone)
        self.assertSame(before, state(mesh))
        self.assertEqual(len(change.notes.faces.added), 2)
        self.assertEqual(change.reports[0]["faces_added"], 2)
        change.redo()
        self.assertEqual(len(mesh.faces), 128)

    def test_an_exception_takes_the_whole_block_back(self):
        mesh = rough(hole={(2, 3)})
        before = state(mesh)
        with self.assertRaises(tri.InvalidInput), mesh.record() as change:
            tri.ops.smooth(mesh)
            tri.ops.fill_holes(mesh, max_edges=1)
        self.assertTrue(change.undone)
        self.assertSame(before, state(mesh))

        def stop(step, share):
            raise KeyError(step)

        with self.assertRaises(KeyError):
            tri.record(mesh, "smooth", iterations=100, progress=stop)
        self.assertSame(before, state(mesh))
        self.assertFalse(tri.record(mesh, "smooth").empty)  # and recording is over

    def test_what_cannot_be_undone_is_refused_and_nothing_changes(self):
        mesh = rough(hole={(2, 3)})
        first = tri.record(mesh, "fill_holes")
        second = tri.record(mesh, "smooth")
        with self.assertRaisesRegex(tri.InvalidInput, "not undone"):
            first.redo()
        tri.ops.compact(tri.Mesh(CUBE_POINTS, CUBE))
        tri.ops.decimate(mesh, faces=50)
        before = state(mesh)
        with self.assertRaises(tri.InvalidInput):
            second.undo()
        self.assertSame(before, state(mesh))

    def test_changes_are_undone_last_first(self):
        mesh = rough(hole={(2, 3)})
        states, changes = [state(mesh)], []
        for name in ("fill_holes", "smooth", "flip_diagonals", "subdivide"):
            changes.append(tri.record(mesh, name))
            states.append(state(mesh))
        for change, expected in zip(reversed(changes), reversed(states[:-1])):
            change.undo()
            self.assertSame(expected, state(mesh))
        for change, expected in zip(changes, states[1:]):
            change.redo()
            self.assertSame(expected, state(mesh))

    def test_a_mesh_is_recorded_once_at_a_time(self):
        mesh = rough()
        with mesh.record() as change:
            with self.assertRaisesRegex(tri.InvalidInput, "recorded already"), mesh.record():
                pass
            tri.ops.smooth(mesh)
        self.assertFalse(change.empty)
        with self.assertRaisesRegex(tri.InvalidInput, "recorded already"), change:
            pass
        with self.assertRaisesRegex(tri.InvalidInput, "unknown operator 'smoothe'"):
            tri.record(mesh, "smoothe")

    def test_a_selection_is_recorded_and_nothing_else_is_kept(self):
        mesh = rough()
        change = tri.record(mesh, "smooth", selection=tri.Selection(vertices=[40]))
        self.assertEqual(change.notes.vertices_moved.tolist(), [40])
        self.assertTrue(tri.record(mesh, "fill_holes", max_edges=3).empty)


class Properties(unittest.TestCase):
    def test_they_go_to_a_soup_and_into_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = folder + "/sheet.ply"
            with open(path, "w", encoding="ascii") as file:
                file.write("ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
                           "property double nx\nproperty double ny\nproperty double nz\nproperty uchar red\nproperty uchar green\n"
                           "property uchar blue\nproperty uchar alpha\nproperty float heat\nelement face 1\n"
                           "property list uchar int vertex_indices\nproperty list uchar double texcoord\nproperty int group\nend_header\n"
                           "0 0 0 0 0 1 1 2 3 200 0.5\n1 0 0 0 0 1 4 5 6 201 1.5\n0 1 0 0 0 1 7 8 9 202 2.5\n"
                           "3 0 1 2 6 0 0 1 0 0 1 4\n")
            mesh = tri.read_mesh(path)
            self.assertEqual(mesh.vertex_properties["normals"].tolist(), [[0, 0, 1]] * 3)
            colors = mesh.vertex_properties["colors"]
            self.assertEqual((colors.dtype, colors.tolist()), (np.uint8, [[1, 2, 3], [4, 5, 6], [7, 8, 9]]))
            colors[0] = (50, 60, 70)
            soup = mesh.to_soup()
            self.assertEqual(soup.vertex_colors[0].tolist(), [50, 60, 70])
            self.assertEqual(soup.vertex_normals.tolist(), [[0, 0, 1]] * 3)
            self.assertEqual(soup.vertex_scalars["heat"].tolist(), [0.5, 1.5, 2.5])
            self.assertEqual(soup.vertex_scalars["alpha"].tolist(), [200, 201, 202])
            self.assertEqual(soup.face_scalars["group"].tolist(), [4])
            self.assertEqual(soup.corner_scalars["s"].tolist(), [[0, 1, 0]])
            self.assertEqual(tri.write(folder + "/back.ply", mesh), [])
            back = tri.read_soup(folder + "/back.ply")
            self.assertEqual(back.vertex_scalars["alpha"].tolist(), [200, 201, 202])
            self.assertEqual(back.corner_scalars["t"].tolist(), [[0, 0, 1]])


if __name__ == "__main__":
    unittest.main()
