#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/point_formats/e57_pages.hpp"
#include "io/point_formats/e57_structure.hpp"

namespace tri::io_detail {

/// The records of one scan, decoded packet by packet: each field has a bytestream of its own that goes on from packet
/// to packet, and packets need not hold the same number of values of every field (ASTM E2807-11, clause 9).
///
/// Memory: the values of about a packet (64 kB) for each field that is asked for.
class E57Records {
 public:
  /// @param wanted one entry per field of the scan: whether its values are needed
  /// @throws IoError if the section is not where the scan says, or too small for its number of records
  E57Records(E57Pages& pages, const E57Scan& scan, std::vector<bool> wanted);

  /// Decodes further packets until at least one more record is complete; false when all have been taken.
  /// @throws IoError with a byte offset: truncated, no packet, a wrong checksum.
  bool next();

  std::size_t available() const { return available_; }  ///< complete records since `next`
  std::uint64_t first() const { return first_; }        ///< index of the first of them
  /// Value of a wanted field; `record` is below available(). What an integer field holds is exact up to 2^53.
  double value(std::size_t field, std::size_t record) const {
    const Column& column = columns_[field];
    return column.bits == 0 ? column.constant : column.values[column.taken + record];
  }
  std::uint64_t packet() const { return packet_; }  ///< physical offset of the packet decoded last, for messages

 private:
  struct Column {
    unsigned bits = 0;
    bool wanted = false;
    double constant = 0;         // of a field without bits
    std::vector<double> values;  // decoded; those before `taken` belong to earlier records
    std::size_t taken = 0;
    std::uint64_t decoded = 0;  // since the first record
    std::string carry;          // bytes of which some bits are left
    unsigned carry_bit = 0;     // first bit of them that is left
  };

  void read_packet();
  void decode(std::size_t field, const char* bytes, std::size_t size);

  E57Pages& pages_;
  const E57Scan& scan_;
  std::vector<Column> columns_;
  std::uint64_t at_ = 0, left_ = 0;  // physical offset of the next packet, logical bytes of the section from there
  std::uint64_t packet_ = 0;
  std::uint64_t first_ = 0;
  std::size_t available_ = 0;
  std::string buffer_;
};

}  // namespace tri::io_detail
