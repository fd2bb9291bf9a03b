#pragma once

#include <span>
#include <string>

#include "libtri/registration.hpp"
#include "meshops/context.hpp"
#include "meshops/points/point_set.hpp"

namespace tri {

/// Writes where points lie on a model, one record a point in their order, as the file name ends:
///
/// - .csv: a header and one line a point, `index,x,y,z,face,u,v,fx,fy,fz,deviation,on_edge`;
/// - .ply: binary, little endian; `double x y z`, `int point_index cad_face`, `double u v deviation fx fy fz`,
///   `uchar on_edge`.
///
/// The index is 0-based. The face is CadFace::index; 0 for a point without a foot, whose u to deviation are NaN. (u,v)
/// are those of the face's own surface as read, (fx,fy,fz) is the closest point on the model, lengths are in mm,
/// on_edge is 1 if that point lies on a trimming curve, else 0. Numbers in CSV are the shortest decimals that read back
/// as the same doubles.
///
/// Behind these columns come what else is known of the points: `nx,ny,nz` (in PLY double), `intensity` (double),
/// `red,green,blue` (whole numbers from 0 to 255), and the further columns by name (double); one that has the name of
/// a column before it becomes `input_NAME`. The file appears whole or not at all.
///
/// @param feet as `Registration::register_points` gave them for `points` and this model
/// @throws InvalidInput for another extension, or if there are not as many feet as points
/// @throws IoError as `AtomicFile` does; Cancelled
void write_registration(const std::string& path, const PointSet& points, std::span<const Foot> feet,
                        const CadModel& model, Context& context);

}  // namespace tri
