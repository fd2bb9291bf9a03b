#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tri {

/// An output file that appears whole under its name or not at all.
///
/// Bytes go through a buffer into a temporary file in the same folder; `commit` flushes it to the disk and renames it
/// over the target in one step. A destructor without `commit` removes the temporary file, so an exception leaves
/// nothing behind and an older file of that name as it was. A symbolic link is followed: the file it names is replaced,
/// the link stays.
///
/// What cannot be renamed over (a device, a named pipe, a terminal; "-" for standard output) is written directly.
///
///     AtomicFile file(path);
///     file.write(bytes);
///     file.commit();
class AtomicFile {
 public:
  /// Makes the temporary file.
  /// @param path target in the file system's own encoding, or "-" for standard output
  /// @throws IoError if the target is a folder or write-protected, or the folder is missing or not writable.
  explicit AtomicFile(std::string path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Appends bytes. @throws IoError when the disk is full or fails; the object can then only be destroyed.
  void write(std::string_view bytes);

  /// Appends the raw bytes of a trivially copyable value, in the machine's byte order.
  template <class Value>
  void write_value(const Value& value) {
    write({reinterpret_cast<const char*>(&value), sizeof(Value)});
  }

  /// Makes the file appear. Further writes are not allowed. @throws IoError; the target is then as it was.
  void commit();

  /// The target as given.
  const std::string& path() const noexcept { return path_; }

  /// Name of the file to be filled by a library that opens files by name. Nothing may have been written through
  /// `write`. Such a library must have closed it before `commit`.
  const std::string& temporary_path() const noexcept { return temporary_; }

 private:
  void flush();
  [[noreturn]] void fail(const std::string& what, int error_number);

  std::string path_;       // as given, for messages
  std::string target_;     // with symbolic links resolved
  std::string temporary_;  // what is open; equals target_ when written directly
  std::vector<char> buffer_;
  int descriptor_ = -1;
  bool direct_ = false;  // no rename: device, pipe or standard output
  bool committed_ = false;
};

/// Writes a whole text or binary file. @throws IoError as `AtomicFile` does.
void write_file(const std::string& path, std::string_view bytes);

}  // namespace tri
