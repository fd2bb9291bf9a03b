#pragma once

#include <string>
#include <string_view>

namespace tri {

/// All bytes of an input file.
///
/// A large regular file is mapped, so that its bytes cost no memory of their own; a small one, a pipe or "-" (standard
/// input) is read into memory. The file must not be shortened while the object lives.
class InputFile {
 public:
  /// @param path file name in the file system's own encoding, or "-" for standard input
  /// @throws IoError if it is missing, a folder, not readable, or empty.
  explicit InputFile(std::string path);
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile();

  /// Never empty; valid while the object lives.
  std::string_view bytes() const noexcept { return bytes_; }
  /// For messages: the path as given, or "standard input".
  const std::string& name() const noexcept { return name_; }

 private:
  std::string name_;
  std::string storage_;
  void* mapping_ = nullptr;
  std::string_view bytes_;
};

/// Lower-case ending of a file name without its dot: "stl" for "Part.STL"; empty if there is none.
std::string file_extension(const std::string& path);

}  // namespace tri
