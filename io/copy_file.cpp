#include "io/copy_file.hpp"

#include "io/atomic_file.hpp"
#include "io/input_file.hpp"

namespace tri {

void copy_file(const std::string& from, const std::string& to) {
  const InputFile in(from);
  AtomicFile out(to);
  out.write(in.bytes());
  out.commit();
}

}  // namespace tri
