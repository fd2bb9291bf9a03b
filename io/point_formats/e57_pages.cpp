#include "io/point_formats/e57_pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "io/point_formats/crc32c.hpp"
#include "meshops/error.hpp"

namespace tri::io_detail {
namespace {

static_assert(std::endian::native == std::endian::little, "E57 is little endian");

constexpr std::size_t header_size = 48;
constexpr std::uint64_t checksum_size = 4;

template <class Value>
Value header_value(std::string_view bytes, std::size_t offset) {
  Value value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace

E57Pages::E57Pages(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {
  if (bytes.size() < header_size) fail(fmt::format("truncated: {} bytes are no header of E57", bytes.size()), 0);
  const auto major = header_value<std::uint32_t>(bytes, 8), minor = header_value<std::uint32_t>(bytes, 12);
  if (major != 1) fail(fmt::format("E57 version {}.{} is not read, only 1", major, minor), 8);
  const auto length = header_value<std::uint64_t>(bytes, 16);
  page_size_ = header_value<std::uint64_t>(bytes, 40);
  // The standard has 1024; any power of two is as good.
  if (page_size_ < 64 || page_size_ > (std::uint64_t{1} << 30) || !std::has_single_bit(page_size_))
    fail(fmt::format("pages of {} bytes are not possible", page_size_), 40);
  payload_ = page_size_ - checksum_size;
  if (length > bytes.size())
    fail(fmt::format("truncated: the header says {} bytes, the file has {}", length, bytes.size()), bytes.size());
  if (length % page_size_ != 0)
    fail(fmt::format("the header says {} bytes, which is no whole number of pages", length), 16);
  if (length == 0) fail("the header says 0 bytes", 16);
  bytes_ = bytes.substr(0, length);
  verified_.resize(length / page_size_, false);
  verify(0);
  xml_offset_ = header_value<std::uint64_t>(bytes, 24);
  xml_size_ = header_value<std::uint64_t>(bytes, 32);
  if (xml_offset_ >= length || xml_size_ == 0 || xml_size_ > remaining(xml_offset_))
    fail(fmt::format("an XML section of {} bytes at byte {} is not within the file", xml_size_, xml_offset_), 24);
}

void E57Pages::fail(const std::string& message, std::uint64_t physical) const {
  throw IoError(file_, message, IoError::Unit::byte, physical);
}

std::uint64_t E57Pages::logical(std::uint64_t physical, const char* what) const {
  const std::uint64_t within = physical % page_size_;
  if (physical >= bytes_.size() || within >= payload_)
    throw IoError(file_, fmt::format("{} cannot be at byte {}", what, physical), IoError::Unit::byte,
                  std::min<std::uint64_t>(physical, bytes_.size()));
  return physical / page_size_ * payload_ + within;
}

std::uint64_t E57Pages::advanced(std::uint64_t physical, std::uint64_t distance) const {
  const std::uint64_t at = physical / page_size_ * payload_ + std::min(physical % page_size_, payload_) + distance;
  return at / payload_ * page_size_ + at % payload_;
}

std::uint64_t E57Pages::remaining(std::uint64_t physical) const {
  const std::uint64_t all = bytes_.size() / page_size_ * payload_;
  const std::uint64_t at = physical / page_size_ * payload_ + std::min(physical % page_size_, payload_);
  return at < all ? all - at : 0;
}

void E57Pages::verify(std::uint64_t page) {
  if (verified_[page]) return;
  const std::string_view content = bytes_.substr(page * page_size_, payload_);
  std::uint32_t stored = 0;  // big endian, unlike everything else in the file
  for (std::uint64_t i = 0; i < checksum_size; ++i)
    stored = stored << 8 | static_cast<unsigned char>(bytes_[page * page_size_ + payload_ + i]);
  const std::uint32_t found = crc32c(content);
  if (found != stored)
    fail(fmt::format("the file is damaged: the checksum of page {} is {:08x}, its content gives {:08x}", page, stored,
                     found),
         page * page_size_);
  verified_[page] = true;
}

void E57Pages::read(std::uint64_t physical, std::size_t size, char* to, const char* what) {
  const std::uint64_t first = logical(physical, what);
  if (size > remaining(physical))
    fail(fmt::format("truncated: {} needs {} bytes, {} are left", what, size, remaining(physical)), physical);
  for (std::uint64_t at = first; size > 0;) {
    const std::uint64_t page = at / payload_, within = at % payload_;
    const std::size_t count = std::min<std::uint64_t>(size, payload_ - within);
    verify(page);
    std::memcpy(to, bytes_.data() + page * page_size_ + within, count);
    to += count;
    at += count;
    size -= count;
  }
}

}  // namespace tri::io_detail
