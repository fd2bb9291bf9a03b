#include "io/input_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "meshops/error.hpp"

namespace tri {
namespace {

// Below this size copying is cheaper than the page faults of a mapping.
constexpr std::size_t mapping_threshold = std::size_t{1} << 18;

struct Descriptor {
  int number;
  bool owned;
  ~Descriptor() {
    if (owned && number >= 0) close(number);
  }
};

}  // namespace

InputFile::InputFile(std::string path) : name_(path == "-" ? "standard input" : path) {
  const auto fail = [this](int error_number) {
    throw IoError(name_, "cannot be read: " + std::generic_category().message(error_number));
  };
  const bool standard_input = path == "-";
  const Descriptor file{standard_input ? STDIN_FILENO : open(path.c_str(), O_RDONLY | O_CLOEXEC), !standard_input};
  if (file.number < 0) {
    if (errno == ENOENT) throw IoError(name_, "there is no such file");
    fail(errno);
  }
  struct stat status {};
  if (fstat(file.number, &status) != 0) fail(errno);
  if (S_ISDIR(status.st_mode)) throw IoError(name_, "cannot be read: it is a folder");

  const bool regular = S_ISREG(status.st_mode);
  const auto size = static_cast<std::size_t>(std::max<off_t>(status.st_size, 0));
  if (regular && !standard_input && size >= mapping_threshold) {
    mapping_ = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number, 0);
    if (mapping_ == MAP_FAILED) {
      mapping_ = nullptr;
      fail(errno);
    }
    bytes_ = {static_cast<const char*>(mapping_), size};
    return;
  }
  std::size_t filled = 0;
  if (regular) storage_.resize(size + 1);
  while (true) {
    if (filled == storage_.size()) storage_.resize(std::max<std::size_t>(storage_.size() * 2, 1 << 16));
    const ssize_t count = read(file.number, storage_.data() + filled, storage_.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(errno);
    if (count == 0) break;
    filled += static_cast<std::size_t>(count);
  }
  storage_.resize(filled);
  if (filled == 0) throw IoError(name_, "is empty");
  bytes_ = storage_;
}

InputFile::~InputFile() {
  if (mapping_) munmap(mapping_, bytes_.size());
}

std::string file_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c); });
  return extension;
}

}  // namespace tri
