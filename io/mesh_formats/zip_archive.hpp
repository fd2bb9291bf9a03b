#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tri::io_detail {

/// A ZIP archive in memory, read with libzip. Untrusted: an entry that claims to unfold to more than 200 times the
/// archive and one megabyte is refused, and what is unfolded arrives in pieces.
class ZipArchive {
 public:
  /// @param bytes must outlive the object @param file for messages
  /// @throws IoError if it is no ZIP archive
  ZipArchive(std::string_view bytes, const std::string& file);
  ~ZipArchive();
  ZipArchive(const ZipArchive&) = delete;
  ZipArchive& operator=(const ZipArchive&) = delete;

  bool has(const std::string& name) const;
  std::vector<std::string> names() const;

  /// Calls `piece` with the entry's bytes, in order, in pieces of at most 64 KB.
  /// @throws IoError if there is no such entry, or it is damaged, encrypted or absurdly large
  void read(const std::string& name, const std::function<void(std::string_view)>& piece) const;

 private:
  struct Handle;
  std::unique_ptr<Handle> handle_;
  const std::string& file_;
  std::size_t size_;
};

/// A ZIP archive of these entries (name, content), compressed; the same bytes for the same entries at any time.
/// @throws IoError naming `file` if libzip fails
std::string zip_of(const std::vector<std::pair<std::string, std::string>>& entries, const std::string& file);

}  // namespace tri::io_detail
