"""The boot lid of the paper, from nothing to numbers: boot_lid.py [FOLDER]

A car boot lid of 16 trimmed NURBS faces is built, measured virtually in a pose of its own, aligned, triangulated and compared
with its model [Ristic, Brujic & Handayani 2000]. Run it cell by cell, or as a whole; it ends with an error if a number is not
what it should be.
"""

# %% The model, and 3400 noisy points on it, somewhere else in space
import pathlib
import sys

import numpy as np

import tri

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "boot_lid")
folder.mkdir(parents=True, exist_ok=True)

noise = 0.02  # mm
lid = tri.example_part("boot-lid")
measured = tri.measure(lid, 3400, noise=noise, move=True, seed=1)
scan = measured["points"]
print(f"{lid}, diagonal {lid.diagonal:.0f} mm; {scan}")
assert len(lid.faces) == 16 and len(scan) == 3400

# %% Where are they? The pose is found from nothing.
aligned = tri.align(lid, scan)
error = np.abs(aligned.pose - measured["to_model"])
print(f"alignment: {aligned.report['status']}, off the truth by at most {error[:3, 3].max():.4f} mm "
      f"and {error[:3, :3].max():.1e} in the rotation")
assert aligned.report["status"] == "good"

# %% One mesh through the points
steps = []
result = tri.triangulate(lid, aligned.points, patches=True, progress=lambda step, share: steps.append(step))
mesh, report = result.mesh, result.report
print(f"{mesh}, method {report['method']}; {len(report['outliers'])} outliers, "
      f"topology {report['topology']['mesh']}, as the model's: {report['topology']['same']}")
assert report["topology"]["same"] and report["checks"]["self_intersections"] == 0
assert len(mesh.points) + len(report["outliers"]) + len(report["duplicates"]) == 3400

# %% Every vertex is a measured point, exactly where it was measured
index = mesh.vertex_properties["point_index"]
assert (mesh.points == aligned.points.points[index]).all()

# %% The numbers: how the part deviates from its model
compared = tri.compare(lid, aligned.points, tolerance=(-3 * noise, 3 * noise))
overall = compared.report["overall"]
print(f"deviation: mean {overall['mean']:+.4f} mm, standard deviation {overall['standard_deviation']:.4f} mm, "
      f"{100 * overall['share_in_tolerance']:.1f}% within three of the noise's")
assert abs(overall["standard_deviation"] - noise) < 0.1 * noise

corners = mesh.points[mesh.faces]
normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
area = 0.5 * np.linalg.norm(normals, axis=1).sum()
area_of_model = sum(face["area"] for face in lid.faces)
print(f"area: {area:.0f} mm2 of the model's {area_of_model:.0f} mm2")
assert 0.95 < area / area_of_model < 1.01

# %% Files, for other programs
tri.write(folder / "boot-lid.ply", mesh)
tri.write(folder / "boot-lid-patches.ply", result.patches)
tri.write(folder / "boot-lid.xyz", aligned.points)
print("written to", folder)
