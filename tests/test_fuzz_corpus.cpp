#include <doctest/doctest.h>

#include <filesystem>

#include "fuzz/invariants.hpp"
#ifdef TRI_WITH_3MF
#include "io/mesh_formats/zip_archive.hpp"
#endif
#include "temporary_folder.hpp"

using namespace tri;

TEST_CASE("fuzz corpus: every file is read consistently or refused with an IoError") {
  int files = 0, accepted = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(TRI_FUZZ_CORPUS)) {
    if (!entry.is_regular_file()) continue;
    const std::string format = entry.path().parent_path().filename().string();
    CAPTURE(entry.path().string());
    const std::string bytes = test::file_bytes(entry.path().string());
    bool fine = false;
    if (format == "points" || format == "ptx" || format == "e57")
      CHECK_NOTHROW(fine = fuzz::read_as_points(bytes, "input." + (format == "points" ? "xyz" : format)));
#ifdef TRI_WITH_3MF
    else if (format == "3mf" && !bytes.starts_with("PK"))  // the model within the archive
      CHECK_NOTHROW(fine =
                        fuzz::read_as_mesh(io_detail::zip_of({{"3D/3dmodel.model", bytes}}, "input.3mf"), "input.3mf"));
#endif
    else
      CHECK_NOTHROW(fine = fuzz::read_as_mesh(bytes, "input." + format));
    accepted += fine;
    ++files;
  }
  CHECK(files >= 20);
  CHECK(accepted >= 10);
  CHECK(accepted < files);
}
