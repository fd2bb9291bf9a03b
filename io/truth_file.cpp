#include "io/truth_file.hpp"

#include <fmt/compile.h>
#include <fmt/format.h>

#include <iterator>

#include "io/atomic_file.hpp"

namespace tri {

void write_truth(const std::string& path, const VirtualMeasurement& measurement, Context& context) {
  AtomicFile file(path);
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "index,face,u,v,x,y,z,nx,ny,nz,outlier\n");
  for (std::size_t i = 0; i < measurement.truth.size(); ++i) {
    const TruePoint& t = measurement.truth[i];
    fmt::format_to(std::back_inserter(text), FMT_COMPILE("{},{},{},{},{},{},{},{},{},{},{}\n"), i, t.face, t.uv[0],
                   t.uv[1], t.point[0], t.point[1], t.point[2], t.normal[0], t.normal[1], t.normal[2],
                   t.outlier ? 1 : 0);
    if (text.size() > 1 << 16) {
      context.checkpoint();
      file.write({text.data(), text.size()});
      text.clear();
    }
  }
  file.write({text.data(), text.size()});
  file.commit();
}

}  // namespace tri
