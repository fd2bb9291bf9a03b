#pragma once

namespace tri::property {

/// Prefix of the mesh properties that name what a face property counts in: "m:labels:group" is the
/// std::vector<std::string> of the names for "f:group", as `Soup::face_labels`.
inline constexpr const char* labels = "m:labels:";

}  // namespace tri::property
