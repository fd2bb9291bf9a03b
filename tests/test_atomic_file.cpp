#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <thread>

#include "io/atomic_file.hpp"
#include "io/input_file.hpp"
#include "io/json_file.hpp"
#include "meshops/error.hpp"
#include "temporary_folder.hpp"

using namespace tri;
using test::file_bytes;
using test::TemporaryFolder;

namespace {

// Permissions bind everyone but root: a test run as root steps down for a moment.
struct AsNobody {
  const bool root = geteuid() == 0;
  AsNobody() {
    if (root) REQUIRE(seteuid(65534) == 0);
  }
  ~AsNobody() {
    if (root) (void)!seteuid(0);
  }
};

// A limit on the file size fails a write in the middle of a regular file, as a full disk does.
struct FileSizeLimit {
  rlimit before{};
  explicit FileSizeLimit(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before);
    rlimit limit = before;
    limit.rlim_cur = bytes;
    REQUIRE(setrlimit(RLIMIT_FSIZE, &limit) == 0);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, SIG_DFL);
  }
};

}  // namespace

TEST_CASE("AtomicFile: nothing stands under the name before commit, everything after") {
  TemporaryFolder folder;
  const std::string path = folder / "out.bin";
  const std::string small = "head\n";
  const std::string large(3'000'000, 'x');  // beyond the buffer
  {
    AtomicFile file(path);
    file.write(small);
    file.write(large);
    file.write_value(std::uint16_t{0x4142});
    CHECK_FALSE(std::filesystem::exists(path));
    file.commit();
  }
  CHECK(file_bytes(path).substr(0, 5) == small);
  CHECK(file_bytes(path).size() == small.size() + large.size() + 2);
  CHECK(folder.entries().size() == 1);
}

TEST_CASE("AtomicFile: without commit the older file stays and nothing is left over") {
  TemporaryFolder folder;
  const std::string path = folder.make("out.txt", "old");
  {
    AtomicFile file(path);
    file.write("new");
  }
  CHECK(file_bytes(path) == "old");
  CHECK(folder.entries().size() == 1);
}

TEST_CASE("AtomicFile: a disk that fills up is an IoError, the older file stays, nothing is left over") {
  TemporaryFolder folder;
  const std::string path = folder.make("out.txt", "old");
  {
    const FileSizeLimit limit(4096);
    CHECK_THROWS_AS(write_file(path, std::string(5'000'000, 'x')), IoError);
    CHECK_THROWS_AS(write_file(path, std::string(10'000, 'x')), IoError);  // noticed only when the buffer is flushed
  }
  CHECK(file_bytes(path) == "old");
  CHECK(folder.entries().size() == 1);
  CHECK_THROWS_AS(write_file("/dev/full", "x"), IoError);
}

TEST_CASE("AtomicFile: a folder, a missing folder and a read-only folder are refused") {
  TemporaryFolder folder;
  CHECK_THROWS_WITH_AS(AtomicFile{folder.path()}, doctest::Contains("folder"), IoError);
  CHECK_THROWS_AS(AtomicFile{folder / "new/"}, IoError);
  CHECK_THROWS_WITH_AS(AtomicFile{folder / "no/such/out.stl"}, doctest::Contains("no folder"), IoError);
  const std::string as_folder = folder.make("file", "x");
  CHECK_THROWS_AS(AtomicFile{as_folder + "/out.stl"}, IoError);
  CHECK_THROWS_AS(AtomicFile{""}, IoError);
  {
    chmod(folder.path().c_str(), 0555);
    const AsNobody nobody;
    CHECK_THROWS_AS(AtomicFile{folder / "out.stl"}, IoError);
  }
  CHECK(folder.entries().size() == 1);
}

TEST_CASE("AtomicFile: a write-protected file is not replaced though its folder would allow it") {
  TemporaryFolder folder;
  const std::string path = folder.make("out.txt", "old");
  chmod(path.c_str(), 0444);
  chmod(folder.path().c_str(), 0777);
  {
    const AsNobody nobody;
    CHECK_THROWS_AS(write_file(path, "new"), IoError);
  }
  CHECK(file_bytes(path) == "old");
}

TEST_CASE("AtomicFile: keeps the permissions of the file it replaces and follows a symbolic link") {
  TemporaryFolder folder;
  const std::string path = folder.make("real.txt", "old");
  chmod(path.c_str(), 0640);
  std::filesystem::create_symlink("real.txt", folder / "link.txt");
  write_file(folder / "link.txt", "new");
  CHECK(std::filesystem::is_symlink(folder / "link.txt"));
  CHECK(file_bytes(path) == "new");
  struct stat status {};
  REQUIRE(stat(path.c_str(), &status) == 0);
  CHECK((status.st_mode & 0777) == 0640);
}

TEST_CASE("AtomicFile: a device is written, not replaced") {
  write_file("/dev/null", "gone");
  CHECK(std::filesystem::is_character_file("/dev/null"));
}

TEST_CASE("InputFile: missing, folder and empty are IoErrors that name the file") {
  TemporaryFolder folder;
  CHECK_THROWS_WITH_AS(InputFile(folder / "none.stl"), doctest::Contains("none.stl"), IoError);
  CHECK_THROWS_WITH_AS(InputFile(folder.path()), doctest::Contains("folder"), IoError);
  CHECK_THROWS_WITH_AS(InputFile(folder.make("empty", "")), doctest::Contains("empty"), IoError);
  const std::string secret = folder.make("secret", "x");
  chmod(secret.c_str(), 0);
  chmod(folder.path().c_str(), 0755);
  const AsNobody nobody;
  CHECK_THROWS_AS(InputFile{secret}, IoError);
}

TEST_CASE("InputFile: small, mapped and piped files give the same bytes") {
  TemporaryFolder folder;
  for (const std::size_t size : {1u, 1000u, 300'000u}) {
    std::string bytes(size, ' ');
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7);
    CHECK(InputFile(folder.make("file", bytes)).bytes() == bytes);
    const std::string pipe = folder / ("pipe" + std::to_string(size));
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << bytes; });
    const InputFile piped(pipe);
    writer.join();
    CHECK(piped.bytes() == bytes);
  }
}

TEST_CASE("file_extension: lower case, without the dot, of the last component only") {
  CHECK(file_extension("a/b.c/Part.STL") == "stl");
  CHECK(file_extension("a/b.c/part") == "");
  CHECK(file_extension("points.tar.XYZ") == "xyz");
}

TEST_CASE("json files: round trip, and a broken one names the byte") {
  TemporaryFolder folder;
  const nlohmann::json value{{"a", 1.5}, {"b", {1, 2, 3}}};
  write_json(folder / "r.json", value);
  CHECK(read_json(folder / "r.json") == value);
  try {
    read_json(folder.make("bad.json", "{\"a\": ?}"));
    FAIL("accepted");
  } catch (const IoError& error) {
    CHECK(error.unit() == IoError::Unit::byte);
    CHECK(error.position() == 6);
  }
}
