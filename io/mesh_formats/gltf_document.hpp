#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/input_file.hpp"
#include "io/mesh_file.hpp"

// "glTF 2.0 Specification", The Khronos Group, 2021: its JSON, its buffers, and the numbers that accessors find in
// them.
namespace tri::io_detail {

/// The numbers of an accessor, as doubles, which hold every type of glTF exactly; normalised integers as fractions.
struct GltfValues {
  std::size_t count = 0;
  std::size_t components = 0;  ///< of each of the `count` elements
  std::vector<double> values;  ///< count * components
};

/// A glTF file, not trusted: every index, offset and count is checked against what is there before it is used. Errors
/// name the element ("accessors[3].count").
class GltfDocument {
 public:
  using Json = nlohmann::json;

  /// Reads GLB or JSON. Buffers are opened when they are needed; those in files of their own relative to the folder of
  /// `file`.
  /// @param bytes must outlive the object @throws IoError
  GltfDocument(std::string_view bytes, const std::string& file, MeshFileInfo& info);

  const Json& root() const { return root_; }

  /// Element `index` of a list of the root ("nodes"). @throws IoError naming `from`, which refers to it
  const Json& element(const char* list, std::uint64_t index, const std::string& from) const;
  /// A member that is an integer from 0 to 2^53, `otherwise` without it. @throws IoError if it is anything else
  std::uint64_t integer(const Json& object, const char* name, const std::string& where, std::uint64_t otherwise) const;
  /// The same, which must be there.
  std::uint64_t integer(const Json& object, const char* name, const std::string& where) const;
  /// A member that is a list of finite numbers of this length; empty without it.
  std::vector<double> numbers(const Json& object, const char* name, std::size_t size, const std::string& where) const;
  /// A member that is a list; an empty one without it.
  const Json& list(const Json& object, const char* name, const std::string& where) const;
  /// A member that is text; empty without it or if it is anything else.
  static std::string text(const Json& object, const char* name);

  /// The numbers of an accessor whose elements have from `least` to `most` components.
  GltfValues accessor(std::uint64_t index, std::size_t least, std::size_t most, const std::string& from);

  [[noreturn]] void fail(const std::string& where, const std::string& message) const;

 private:
  struct View {
    std::string_view bytes;
    std::uint64_t stride;  ///< 0: elements follow one another
  };
  void split_binary(std::string_view bytes);
  void parse_json(std::string_view text, std::size_t offset);
  std::string_view buffer(std::uint64_t index, const std::string& from);
  std::string_view external(const std::string& uri, const std::string& where);
  View view(std::uint64_t index, const std::string& from);
  /// `count` elements of a view, from an offset, appended as doubles.
  void decode(const View& view, std::uint64_t offset, std::uint64_t count, std::uint64_t type, std::size_t components,
              bool normalized, std::vector<double>& out, const std::string& where) const;

  const std::string& file_;
  std::size_t size_;
  Json root_;
  std::string_view chunk_;  // of a GLB
  bool has_chunk_ = false;
  std::vector<std::string_view> buffers_;  // null data: not opened yet
  std::vector<std::unique_ptr<std::string>> decoded_;
  std::vector<std::unique_ptr<InputFile>> files_;
};

}  // namespace tri::io_detail
