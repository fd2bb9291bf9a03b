#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <system_error>

#include "meshops/error.hpp"

namespace tri {
namespace {

constexpr std::size_t buffer_size = std::size_t{1} << 20;

std::string error_text(int error_number) {
  return std::generic_category().message(error_number);
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

// Follows symbolic links also when the file they name does not exist yet, which realpath does not.
std::string resolve_links(std::string path) {
  for (int depth = 0; depth < 40; ++depth) {
    std::error_code error;
    const std::filesystem::path link = std::filesystem::read_symlink(path, error);
    if (error) return path;
    path = link.is_absolute() ? link.string() : (std::filesystem::path(path).parent_path() / link).string();
  }
  throw IoError(path, "too many levels of symbolic links");
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  buffer_.reserve(buffer_size);
  if (path_ == "-") {
    direct_ = true;
    descriptor_ = dup(STDOUT_FILENO);
    if (descriptor_ < 0) fail("cannot be written", errno);
    return;
  }
  if (path_.empty()) throw IoError(path_, "an empty file name");
  target_ = resolve_links(path_);

  struct stat status {};
  mode_t mode = 0;
  if (stat(target_.c_str(), &status) == 0) {
    if (S_ISDIR(status.st_mode)) throw IoError(path_, "cannot be written: it is a folder");
    if (!S_ISREG(status.st_mode)) {
      direct_ = true;
      temporary_ = target_;
      descriptor_ = open(target_.c_str(), O_WRONLY | O_CLOEXEC);
      if (descriptor_ < 0) fail("cannot be written", errno);
      return;
    }
    // A rename would replace even a file that its owner protected.
    if (faccessat(AT_FDCWD, target_.c_str(), W_OK, AT_EACCESS) != 0) fail("cannot be written", errno);
    mode = status.st_mode & 07777;
  } else if (errno != ENOENT) {
    fail("cannot be written", errno);
  }
  if (target_.back() == '/') throw IoError(path_, "cannot be written: it names a folder");

  const std::string folder = folder_of(target_);
  const std::string name = std::filesystem::path(target_).filename().string().substr(0, 200);
  // Not mkstemp, whose files are private to their owner: the new file gets the permissions that any new file gets.
  auto seed = static_cast<unsigned long long>(std::chrono::steady_clock::now().time_since_epoch().count());
  for (int attempt = 0; attempt < 100 && descriptor_ < 0; ++attempt) {
    temporary_ =
        folder + "/." + name + "." + std::to_string(getpid()) + "-" + std::to_string(seed++ % 1000000007ULL) + ".tmp";
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
  }
  if (descriptor_ < 0) {
    const int error_number = errno;
    temporary_.clear();
    if (error_number == ENOENT || error_number == ENOTDIR)
      throw IoError(path_, "cannot be written: there is no folder " + folder);
    throw IoError(path_, "cannot be written in the folder " + folder + ": " + error_text(error_number));
  }
  if (mode != 0) (void)!fchmod(descriptor_, mode);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!committed_ && !direct_ && !temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
  if (buffer_.size() + bytes.size() > buffer_size) flush();
  if (bytes.size() < buffer_size) {
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
    return;
  }
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot be written", errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void AtomicFile::flush() {
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t written = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot be written", errno);
    done += static_cast<std::size_t>(written);
  }
  buffer_.clear();
}

void AtomicFile::commit() {
  flush();
  // A device or pipe has nothing to synchronise and says EINVAL.
  if (fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS && errno != ENOTSUP)
    fail("cannot be written", errno);
  const int closed = close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) fail("cannot be written", errno);
  if (!direct_) {
    if (rename(temporary_.c_str(), target_.c_str()) != 0) fail("cannot be written", errno);
    committed_ = true;
    // The rename itself lasts only once the folder is on the disk; where that cannot be asked for, the file is still
    // whole.
    const int folder = open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
      (void)!fsync(folder);
      close(folder);
    }
  }
  committed_ = true;
}

void AtomicFile::fail(const std::string& what, int error_number) {
  // Called from the constructor as well, where no destructor would follow.
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
  if (!committed_ && !direct_ && !temporary_.empty()) unlink(temporary_.c_str());
  temporary_.clear();
  throw IoError(path_ == "-" ? "standard output" : path_, what + ": " + error_text(error_number));
}

void write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace tri
