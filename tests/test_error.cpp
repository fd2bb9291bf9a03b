#include <doctest/doctest.h>

#include "meshops/context.hpp"
#include "meshops/error.hpp"

using namespace tri;

TEST_CASE("IoError: names the file and the position") {
  CHECK(std::string(IoError("a.stl", "truncated", IoError::Unit::byte, 84).what()) == "a.stl: byte 84: truncated");
  CHECK(std::string(IoError("a.obj", "bad index", IoError::Unit::line, 7).what()) == "a.obj:7: bad index");
  CHECK(std::string(IoError("a.obj", "is a folder").what()) == "a.obj: is a folder");
}

TEST_CASE("Context: a checkpoint throws only after cancel") {
  Context context;
  CHECK_NOTHROW(context.checkpoint());
  context.cancel();
  CHECK_THROWS_AS(context.checkpoint(), Cancelled);
}
