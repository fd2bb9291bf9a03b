#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tri::io_detail {

/// The lowest layer of an E57 file: pages, each ending in a CRC-32C of the rest of it (ASTM E2807-11, clause 7).
///
/// Offsets within the file are "physical"; what is read is "logical": the pages' contents without the checksums. Each
/// page is verified when it is first read from.
class E57Pages {
 public:
  /// @param bytes the whole file; must outlive this object, as must `file`, its name for messages
  /// @throws IoError if it is no E57 file of a version that is read, or is shorter than its header says
  E57Pages(std::string_view bytes, const std::string& file);

  std::uint64_t xml_offset() const { return xml_offset_; }  ///< physical
  std::uint64_t xml_size() const { return xml_size_; }      ///< logical

  /// Copies `size` logical bytes from a physical offset on. @param what names them in messages
  /// @throws IoError if they are beyond the end, the offset is within a checksum, or a page's checksum is wrong.
  void read(std::uint64_t physical, std::size_t size, char* to, const char* what);

  /// Where the logical byte that lies `distance` logical bytes behind a physical offset is.
  std::uint64_t advanced(std::uint64_t physical, std::uint64_t distance) const;
  /// Logical bytes from a physical offset to the end of the file.
  std::uint64_t remaining(std::uint64_t physical) const;

  [[noreturn]] void fail(const std::string& message, std::uint64_t physical) const;

 private:
  std::uint64_t logical(std::uint64_t physical, const char* what) const;
  void verify(std::uint64_t page);

  std::string_view bytes_;
  const std::string& file_;
  std::uint64_t page_size_ = 0, payload_ = 0;
  std::uint64_t xml_offset_ = 0, xml_size_ = 0;
  std::vector<bool> verified_;
};

}  // namespace tri::io_detail
