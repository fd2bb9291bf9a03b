#pragma once

#include <cstdint>
#include <string_view>

namespace tri::io_detail {

/// The CRC-32C (Castagnoli polynomial, reflected, as in iSCSI, RFC 3720 appendix B.4) of some bytes: 0xE3069283 for
/// "123456789". Eight bytes a step [Kounavis & Berry 2005, "slicing-by-8"].
std::uint32_t crc32c(std::string_view bytes);

}  // namespace tri::io_detail
