#include "io/pose_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/input_file.hpp"
#include "io/json_file.hpp"
#include "io/text_scanner.hpp"
#include "meshops/error.hpp"

namespace tri {

Pose read_pose(const std::string& path) {
  const nlohmann::json json = read_json(path);
  const nlohmann::json* at = &json;
  for (const char* key : {"alignment", "pose"})
    if (at->is_object() && at->contains(key)) at = &(*at)[key];
  const auto fail = [&](const std::string& message) { throw IoError(path, message); };
  if (!at->is_object() || !at->contains("matrix")) fail("holds no pose: {\"matrix\": [[4x4]]} is expected");
  const nlohmann::json& rows = (*at)["matrix"];
  std::array<std::array<double, 4>, 4> matrix{};
  if (!rows.is_array() || rows.size() != 4) fail("the matrix of the pose has not four rows");
  for (std::size_t r = 0; r < 4; ++r) {
    if (!rows[r].is_array() || rows[r].size() != 4)
      fail(fmt::format("row {} of the pose's matrix has not four numbers", r + 1));
    for (std::size_t c = 0; c < 4; ++c) {
      if (!rows[r][c].is_number()) fail(fmt::format("entry {}, {} of the pose's matrix is no number", r + 1, c + 1));
      matrix[r][c] = rows[r][c].get<double>();
    }
  }
  try {
    return pose_of(matrix);
  } catch (const InvalidInput& e) {
    throw IoError(path, e.what());
  }
}

void write_pose(const std::string& path, const Pose& pose) {
  write_json(path, nlohmann::ordered_json{{"matrix", pose.matrix()}, {"meaning", "takes the points to the model"}});
}

PointPairs read_pairs(const std::string& path) {
  const InputFile file(path);
  // Blanks in place of commas and semicolons keep every position.
  std::string text(file.bytes());
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
  io_detail::TextScanner scanner(text, file.name());
  PointPairs pairs;
  while (scanner.next_filled_line('#')) {
    Vec3 point, place;
    for (int k = 0; k < 3; ++k) point[k] = scanner.coordinate("coordinate of the measured point");
    for (int k = 0; k < 3; ++k) place[k] = scanner.coordinate("coordinate of its place on the model");
    if (!scanner.at_line_end('#')) scanner.fail("more than six numbers: x y z X Y Z are expected");
    pairs.points.push_back(point);
    pairs.places.push_back(place);
    scanner.next_line();
  }
  if (pairs.points.size() < 3)
    throw IoError(file.name(),
                  fmt::format("{} pairs of points are too few for a pose: 3 are needed", pairs.points.size()));
  return pairs;
}

}  // namespace tri
