#include "io/point_formats/crc32c.hpp"

#include <array>
#include <bit>
#include <cstring>

namespace tri::io_detail {
namespace {

static_assert(std::endian::native == std::endian::little, "eight bytes are taken as a little-endian number");

using Table = std::array<std::uint32_t, 256>;

constexpr std::array<Table, 8> make_tables() {
  constexpr std::uint32_t reflected_polynomial = 0x82F63B78;
  std::array<Table, 8> tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = c >> 1 ^ (c & 1 ? reflected_polynomial : 0);
    tables[0][i] = c;
  }
  // Table k: the byte is followed by k zero bytes.
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t i = 0; i < 256; ++i) tables[k][i] = tables[k - 1][i] >> 8 ^ tables[0][tables[k - 1][i] & 0xFF];
  return tables;
}

constexpr std::array<Table, 8> tables = make_tables();

}  // namespace

std::uint32_t crc32c(std::string_view bytes) {
  std::uint32_t c = 0xFFFFFFFF;
  const char* p = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; p += 8, left -= 8) {
    std::uint64_t eight;
    std::memcpy(&eight, p, 8);
    eight ^= c;
    c = 0;
    for (std::size_t k = 0; k < 8; ++k) c ^= tables[7 - k][eight >> 8 * k & 0xFF];
  }
  for (; left > 0; ++p, --left) c = c >> 8 ^ tables[0][(c ^ static_cast<unsigned char>(*p)) & 0xFF];
  return ~c;
}

}  // namespace tri::io_detail
