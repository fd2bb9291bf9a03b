"""Tests of the module tri. Oracles are closed forms and numpy."""

import ast
import inspect
import os
import pathlib
import re
import signal
import tempfile
import threading
import time
import unittest

import numpy as np

import tri


def grid(n, hole=()):
    """A bumpy sheet of n x n squares without those in `hole`: points (float64) and triangles."""
    y, x = np.mgrid[0:n + 1, 0:n + 1].astype(float)
    points = np.stack([x, y, 0.1 * np.sin(x) * np.cos(y)], axis=-1).reshape(-1, 3)
    triangles = []
    for i in range(n):
        for k in range(n):
            if (i, k) in hole:
                continue
            a, b, c, d = i * (n + 1) + k, i * (n + 1) + k + 1, (i + 1) * (n + 1) + k + 1, (i + 1) * (n + 1) + k
            triangles += [(a, b, c), (a, c, d)]
    return points, np.array(triangles)


CUBE_POINTS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
CUBE = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
                 [1, 5, 7], [1, 7, 3]])


class Arrays(unittest.TestCase):
    def test_points_of_a_mesh_are_a_view_that_moves_vertices(self):
        points, triangles = grid(3)
        mesh = tri.Mesh(points, triangles)
        view = mesh.points
        self.assertEqual((view.shape, view.dtype), ((16, 3), np.float64))
        self.assertTrue((view == points).all())
        view[5] = (1, 2, 30)
        self.assertEqual(mesh.points[5, 2], 30)
        self.assertEqual(mesh.to_soup().points[5, 2], 30)
        self.assertEqual(points[5, 2], 0.1 * np.sin(1) * np.cos(1))

    def test_an_array_outlives_its_object(self):
        view = tri.Points(np.arange(3000.0).reshape(-1, 3)).points
        self.assertEqual(view[999, 2], 2999)

    def test_an_array_shows_what_was_there_before_an_operator(self):
        points = np.repeat(np.random.default_rng(1).random((500, 3)), 2, axis=0)
        held = tri.Points(points)
        before = held.points
        tri.ops.thin(held, voxel=0.2)
        self.assertTrue((before == points).all())
        self.assertLess(len(held), 1000)
        self.assertEqual(len(held.points), len(held))

    def test_faces_are_a_copy_without_deleted_ones(self):
        points, triangles = grid(2)
        soup = tri.Soup(points, triangles)
        self.assertTrue((soup.triangles == triangles).all())
        mesh = soup.to_mesh()
        rows = {tuple(sorted(face)) for face in mesh.faces}
        self.assertEqual(rows, {tuple(sorted(face)) for face in triangles})
        self.assertEqual(len(mesh.deleted_faces), 0)

    def test_columns_of_points(self):
        held = tri.Points(np.zeros((2, 3)), normals=[[0, 0, 1], [0, 1, 0]], scalars={"heat": [1, 2]})
        held.scalars["heat"][1] = 7
        self.assertEqual(held.scalars["heat"].tolist(), [1, 7])
        self.assertEqual(held.normals[1].tolist(), [0, 1, 0])
        self.assertIsNone(held.colors)

    def test_what_is_no_array_of_the_right_shape_is_refused(self):
        for points, triangles in [(np.zeros((3, 2)), [[0, 1, 2]]), (np.zeros((3, 3)), [[0, 1, 3]]),
                                  (np.zeros((3, 3)), [[0, 1, -1]]), (np.zeros((4, 3)), [[0, 1, 2, 3]]),
                                  (np.zeros((3, 3)), [[0.0, 1.0, 2.0]]), ("text", [[0, 1, 2]])]:
            with self.subTest(points=points, triangles=triangles), self.assertRaises(tri.InvalidInput):
                tri.Soup(points, triangles)
        with self.assertRaisesRegex(tri.InvalidInput, "cut into triangles"):
            tri.Mesh(np.zeros((4, 3)), [[0, 1, 2, 3]])
        with self.assertRaises(tri.InvalidInput):
            tri.Points([[0, 0, float("nan")]])

    def test_copies_are_independent(self):
        mesh = tri.Mesh(CUBE_POINTS, CUBE)
        other = mesh.copy()
        other.points[0] = 9
        self.assertEqual(mesh.points[0, 0], 0)


class Operators(unittest.TestCase):
    def test_an_operator_runs_in_place_and_reports(self):
        mesh = tri.Mesh(*grid(6, hole={(2, 3)}))
        report = tri.ops.fill_holes(mesh, max_edges=8)
        self.assertEqual(report["operation"], "fill-holes")
        self.assertEqual(report["faces_added"], 2)
        self.assertEqual(report["figures"]["holes filled"], 1)
        self.assertEqual(len(report["touched_faces"]), 2)
        self.assertEqual(len(mesh.faces), 72)
        self.assertTrue(tri.ops.fill_holes(mesh, max_edges=8)["unchanged"])

    def test_every_operator_has_a_function_with_the_options_of_its_schema(self):
        described = {op["name"]: op for op in tri.Registry().describe()}
        self.assertGreater(len(described), 15)
        for name, op in described.items():
            if op["domain"] != op["result"]:
                continue
            function = getattr(tri.ops, name.replace("-", "_"))
            parameters = inspect.signature(function).parameters
            for option in op["options"]:
                own = option["name"].replace("-", "_")
                self.assertIn(own, parameters)
                self.assertIn(option["help"], function.__doc__)
                default = float("inf") if option["default"] == "inf" else option["default"]
                self.assertEqual(parameters[own].default, default)

    def test_every_operator_runs_with_its_defaults_given(self):
        objects = {"mesh": lambda: tri.Mesh(*grid(4)), "soup": lambda: tri.Soup(*grid(4)),
                   "points": lambda: tri.Points(grid(4)[0])}
        for op in tri.Registry().describe():
            if op["domain"] == op["result"]:
                options = {o["name"].replace("-", "_"): o["default"] for o in op["options"]}
                with self.subTest(op["name"]):
                    report = getattr(tri.ops, op["name"].replace("-", "_"))(objects[op["domain"]](), **options)
                    self.assertEqual(report["operation"], op["name"])

    def test_wrong_options_are_refused_by_name_and_leave_the_mesh(self):
        mesh = tri.Mesh(*grid(4, hole={(1, 1)}))
        with self.assertRaisesRegex(tri.InvalidInput, "max-edges = 2 .*from 3"):
            tri.ops.fill_holes(mesh, max_edges=2)
        with self.assertRaisesRegex(tri.InvalidInput, "strategy"):
            tri.ops.fill_holes(mesh, strategy="guess")
        with self.assertRaisesRegex(TypeError, "no option max_edge; allowed: .*max_edges"):
            tri.ops.fill_holes(mesh, max_edge=2)
        with self.assertRaises(tri.InvalidInput):
            tri.ops.fill_holes(tri.Soup(*grid(2)))
        with self.assertRaises(TypeError):
            tri.ops.fill_holes(42)
        self.assertEqual(len(mesh.faces), 30)

    def test_numbers_may_be_numpy_s_and_infinite(self):
        mesh = tri.Mesh(*grid(4, hole={(1, 1)}))
        tri.ops.fill_holes(mesh, max_edges=np.int64(8), max_diameter=np.inf)
        self.assertEqual(len(mesh.faces), 32)

    def test_a_recipe_runs_on_a_copy_and_converts(self):
        soup = tri.Soup(*grid(4, hole={(1, 1)}))
        mesh, reports = tri.run(soup, ["weld", ("fill_holes", {"max_edges": 8}), "compact"])
        self.assertIsInstance(mesh, tri.Mesh)
        self.assertEqual([r["operation"] for r in reports], ["weld", "build-mesh", "fill-holes", "compact"])
        self.assertEqual((len(mesh.faces), len(soup.triangles)), (32, 30))
        again, _ = tri.run(soup, '{"version": 1, "steps": [{"op": "fill-holes", "max-edges": 8}]}')
        self.assertEqual(len(again.faces), 32)
        with self.assertRaisesRegex(tri.InvalidInput, "unknown operator"):
            tri.run(soup, ["fill-hole"])

    def test_building_a_mesh_says_what_it_did(self):
        twisted = CUBE.copy()
        twisted[3] = twisted[3][::-1]
        mesh = tri.Soup(CUBE_POINTS, twisted).to_mesh()
        self.assertEqual(mesh.build_report["operation"], "build-mesh")
        self.assertEqual(mesh.build_report["figures"]["triangles reversed"], 1)

    @unittest.skipUnless("TRI_TEST_PLUGINS" in os.environ, "no plug-ins were built")
    def test_plugins(self):
        folder = pathlib.Path(os.environ["TRI_TEST_PLUGINS"])
        ops = tri.load_plugins(folder / "good")
        mesh = tri.Mesh(CUBE_POINTS, CUBE)
        self.assertEqual(ops.scale(mesh, factor=3)["vertices_moved"], 8)
        self.assertEqual(mesh.points.max(), 3)
        self.assertFalse(hasattr(tri.ops, "scale"))
        tri.run(mesh, [("scale", {"factor": 2})], registry=ops.registry)
        with self.assertRaisesRegex(tri.IoError, "built with .*; here is "):
            tri.load_plugins(folder / "foreign")


class Work(unittest.TestCase):
    """Progress, exceptions from it, Ctrl-C, threads."""

    def big(self):
        return tri.Soup(*grid(120))

    def test_progress_goes_forward(self):
        calls = []
        tri.check(self.big(), progress=lambda step, share: calls.append((step, share)))
        for (step, share), (next_step, next_share) in zip(calls, calls[1:]):
            if step == next_step:
                self.assertLessEqual(share, next_share)

    def test_what_progress_raises_comes_through_and_the_mesh_is_valid(self):
        class Enough(Exception):
            pass

        def stop(step, share):
            raise Enough(step)

        holes = {(i, k) for i in range(1, 58, 2) for k in range(1, 58, 2)}
        mesh = tri.Mesh(*grid(60, hole=holes))
        with self.assertRaises(Enough):
            tri.ops.fill_holes(mesh, max_edges=8, progress=stop)
        kinds = tri.check(mesh)["defects"]
        self.assertFalse({name for name in kinds if "manifold" in name})
        tri.ops.fill_holes(mesh, max_edges=8)
        self.assertEqual(len(mesh.faces), 7200)

    def test_ctrl_c_ends_the_work(self):
        random = np.random.default_rng(2)
        first, second = (tri.Soup(random.random((3000, 3)), random.integers(0, 3000, (4000, 3))) for _ in range(2))
        timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        begin = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            while time.monotonic() - begin < 60:
                tri.mesh_distance(first, second, samples=200000, relative_error=1e-6)
        timer.join()
        self.assertLess(time.monotonic() - begin, 50)

    def test_an_object_in_use_is_refused_elsewhere(self):
        mesh = tri.Mesh(*grid(30, hole={(3, 3), (9, 9)}))
        seen = []

        def look(step, share):
            try:
                mesh.points
            except tri.InvalidInput as error:
                seen.append(str(error))

        tri.ops.fill_holes(mesh, max_edges=8, progress=look)
        self.assertTrue(seen)
        self.assertIn("being changed", seen[0])
        self.assertEqual(len(mesh.points), 961)

    def test_other_threads_of_python_run_meanwhile(self):
        soup = self.big()
        ticks, done = [0], threading.Event()

        def tick():
            while not done.is_set():
                ticks[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        begin = ticks[0]
        time.sleep(0.01)
        tri.check(soup)
        done.set()
        thread.join()
        self.assertGreater(ticks[0], begin)


class Files(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def test_meshes_come_back_as_they_were_written(self):
        soup = tri.Soup(CUBE_POINTS * 0.1, CUBE)
        for ending in ("ply", "obj", "off"):
            self.assertEqual(tri.write(self.path / f"cube.{ending}", soup), [])
            back = tri.read_soup(str(self.path / f"cube.{ending}"))
            self.assertTrue((back.points == soup.points).all())
            self.assertTrue((back.triangles == soup.triangles).all())
        notes = tri.write(self.path / "cube.stl", soup)
        self.assertIn("round", " ".join(notes))
        mesh = tri.read_mesh(self.path / "cube.ply")
        self.assertEqual(tri.check(mesh)["verdict"], "solid")

    def test_points_come_back_with_their_columns(self):
        points = tri.Points([[0, 0, 0.1], [1, 2, 3]], scalars={"heat": [5, 6]})
        tri.write(self.path / "p.csv", points)
        back = tri.read_points(self.path / "p.csv")
        self.assertTrue((back.points == points.points).all())
        self.assertEqual(back.scalars["heat"].tolist(), [5, 6])

    def test_exceptions_say_where(self):
        (self.path / "broken.stl").write_text("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nonsense\n")
        with self.assertRaises(tri.IoError) as caught:
            tri.read_soup(self.path / "broken.stl")
        self.assertEqual((caught.exception.line, caught.exception.byte), (4, None))
        self.assertEqual(caught.exception.file, str(self.path / "broken.stl"))
        for base in (tri.Error, OSError):
            self.assertTrue(issubclass(tri.IoError, base))
        self.assertTrue(issubclass(tri.InvalidInput, ValueError))
        with self.assertRaises(tri.IoError):
            tri.read_soup(self.path / "missing.ply")


class Measures(unittest.TestCase):
    def test_two_parallel_squares_are_as_far_apart_as_their_planes(self):
        square = [[0, 1, 2], [0, 2, 3]]
        corners = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], dtype=float)
        result = tri.mesh_distance(tri.Soup(corners, square), tri.Mesh(corners + [0, 0, 0.25], square))
        self.assertAlmostEqual(result["hausdorff"], 0.25)
        self.assertAlmostEqual(result["rms"], 0.25)
        self.assertTrue(np.allclose(result["forward"]["values"], -0.25))

    def test_repair_closes_a_cube(self):
        soup = tri.Soup(CUBE_POINTS, CUBE[:-1])
        result = tri.repair(soup, goal="solid")
        self.assertTrue(result["changed"])
        self.assertEqual(tri.check(soup)["verdict"], "solid")


@unittest.skipUnless(hasattr(tri, "Model"), "built without OpenCASCADE")
class Cad(unittest.TestCase):
    def setUp(self):
        self.model = tri.example_part("sphere-cap")

    def test_triangulated_points_are_the_vertices(self):
        points = tri.measure(self.model, 800, seed=5)["points"]
        result = tri.triangulate(self.model, points)
        index = result.mesh.vertex_properties["point_index"]
        self.assertTrue((result.mesh.points == points.points[index]).all())
        self.assertEqual(result.mesh.vertex_properties["uv"].shape, (len(index), 2))
        self.assertEqual(result.report["topology"]["mesh"]["euler"], 1)
        with self.assertRaises(tri.InvalidInput):
            tri.triangulate(self.model, points, method="guess")
        with self.assertRaises(tri.InvalidInput):
            tri.triangulate(self.model, points.points[:2])

    def test_deviations_are_those_that_were_made(self):
        measured = tri.measure(self.model, 300, seed=6)
        points = measured["truth"]["point"] + 0.5 * measured["truth"]["normal"]
        compared = tri.compare(self.model, points, tolerance=(0, 1))
        inside = np.abs(compared.values - 0.5) < 1e-6  # points beyond the rim are nearer to it
        self.assertGreater(inside.mean(), 0.8)
        self.assertEqual(compared.report["overall"]["points"], 300)
        feet = tri.register(self.model, points)
        self.assertTrue(np.allclose(np.linalg.norm(points - feet["foot"], axis=1), np.abs(feet["deviation"])))

    def test_a_small_motion_is_undone(self):
        part = tri.example_part("bracket")
        truth = tri.measure(part, 1500, noise=0.01, seed=7)["points"].points
        angle = 0.02
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        aligned = tri.align(part, truth @ turn.T + [0.3, -0.2, 0.4], mode="icp")
        self.assertLess(np.abs(aligned.points.points - truth).max(), 0.02)
        self.assertTrue(np.allclose(aligned.pose[:3, :3], turn.T, atol=1e-3))

    def test_models_as_files(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "cap.brep"
            tri.write_cad(path, self.model)
            back = tri.read_cad(path)
            self.assertEqual([f["surface"] for f in back.faces], [f["surface"] for f in self.model.faces])
            with self.assertRaises(tri.IoError):
                tri.read_cad(pathlib.Path(folder) / "none.step")


class Stubs(unittest.TestCase):
    """The type stubs say what is there."""

    folder = pathlib.Path(tri.__file__).parent

    def names_of(self, tree):
        return {node.name: node for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}

    def arguments(self, node):
        a = node.args
        return [x.arg for x in a.posonlyargs + a.args + [a.vararg] + a.kwonlyargs + [a.kwarg] if x]

    def runtime_arguments(self, function):
        try:
            return list(inspect.signature(function).parameters)
        except ValueError:  # compiled: the first line of its text is the signature
            line = function.__doc__.splitlines()[0]
            inner = line[line.index("(") + 1:line.rindex(") ->")]
            inner = re.sub(r"\[[^][]*\]", "", inner)
            return [part.split(":")[0].strip() for part in inner.split(",") if part.strip() not in ("*", "/", "")]

    def test_operators(self):
        stubs = self.names_of(ast.parse((self.folder / "ops.pyi").read_text()))
        self.assertEqual(sorted(stubs), tri.ops.__all__)
        for name, node in stubs.items():
            self.assertEqual(self.arguments(node), self.runtime_arguments(getattr(tri.ops, name)), name)

    def test_everything_else(self):
        stubs = self.names_of(ast.parse((self.folder / "__init__.pyi").read_text()))
        if hasattr(tri, "Model"):
            self.assertEqual(sorted(stubs), sorted(set(tri.__all__) - {"ops"}))
        for name, node in stubs.items():
            if not hasattr(tri, name):
                continue
            if isinstance(node, ast.FunctionDef):
                self.assertEqual(self.arguments(node), self.runtime_arguments(getattr(tri, name)), name)
            elif not issubclass(getattr(tri, name), (tuple, Exception)):
                members = {m.name for m in node.body if isinstance(m, ast.FunctionDef) and not m.name.startswith("_")}
                self.assertEqual(members, {m for m in vars(getattr(tri, name)) if not m.startswith("_")}, name)


if __name__ == "__main__":
    unittest.main()
