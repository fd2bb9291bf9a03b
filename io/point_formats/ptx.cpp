#include <fmt/format.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>

#include "io/point_formats/points_formats.hpp"
#include "io/text_scanner.hpp"

// PTX (Leica Cyclone): for each scan the numbers of columns and rows, the scanner's place and axes, a matrix of 4 x 4
// that takes a row vector (x y z 1) to the common frame, then columns * rows lines "x y z [intensity [red green blue]]"
// in the scanner's frame. A line 0 0 0 is a direction from which nothing came back.
namespace tri::io_detail {
namespace {

constexpr std::uint64_t most_cells = 0xFFFFFFFE;
constexpr std::size_t ptx_chunk_size = std::size_t{1} << 20;
// Between two looks at the context; each has points of its own until they are joined.
constexpr std::size_t ptx_chunks_at_once = 16;
constexpr std::uint64_t shortest_line = 6;  // "0 0 0" and what ends it

struct Scan {
  std::uint64_t cells = 0;
  std::array<Vec3, 3> rotation;  // rows; point = rotation * own + translation
  Vec3 translation;
  const char* first = nullptr;  // of the lines of its cells
  const char* last = nullptr;
  int values = 0;  // of each line: 3, 4 or 7
};

struct PtxChunk {
  const char* first;
  const char* last;
  PointSet set;
  std::uint64_t skipped = 0;
  std::exception_ptr error;
};

class PtxParser {
 public:
  PtxParser(std::string_view bytes, const std::string& file, PointsFileInfo& info)
      : bytes_(bytes), file_(file), info_(info), scanner_(bytes, file) {}

  PointSet run(Context& context) {
    find_scans(context);
    std::uint64_t total = 0;
    for (const Scan& scan : scans_) total += scan.cells;
    set_.points.reserve(total);
    for (std::size_t k = 0; k < scans_.size(); ++k) read_scan(k, total, context);
    if (info_.points_skipped > 0)
      info_.notes.push_back(
          fmt::format("{} cells of {} without a return (0 0 0) were skipped", info_.points_skipped, total));
    return std::move(set_);
  }

 private:
  // The end of a line is a line feed or, in old files, a lone carriage return.
  const char* skip_lines(const char* p, std::uint64_t& lines) const {
    const char* const end = bytes_.data() + bytes_.size();
    while (lines > 0 && p < end) {
      const auto* next = static_cast<const char*>(std::memchr(p, line_end_, static_cast<std::size_t>(end - p)));
      p = next ? next + 1 : end;
      --lines;
    }
    return p;
  }

  std::uint64_t count(const char* what) {
    const std::int64_t value = scanner_.integer(what);
    if (value < 0 || static_cast<std::uint64_t>(value) > most_cells)
      scanner_.fail(fmt::format("{} is {}", what, value));
    end_line();
    return static_cast<std::uint64_t>(value);
  }
  void end_line() {
    if (!scanner_.at_line_end()) scanner_.fail(quoted(scanner_.token()) + " where the line should end");
    scanner_.next_line();
  }

  // Headers first, so that memory is asked for once and every line can be read at any time.
  void find_scans(Context& context) {
    line_end_ = bytes_.find('\n') == std::string_view::npos ? '\r' : '\n';
    while (scanner_.next_filled_line(0)) {
      context.checkpoint();
      Scan scan;
      read_header(scan);
      scan.first = scanner_.position();
      if (scan.cells > (scanner_.remaining() + 1) / shortest_line)
        scanner_.fail(fmt::format("truncated or absurd: {} cells in {} bytes", scan.cells, scanner_.remaining()));
      std::uint64_t missing = scan.cells;
      scan.last = skip_lines(scan.first, missing);
      if (missing > 0)
        scanner_.fail(fmt::format("truncated: {} of {} cells", scan.cells - missing, scan.cells), scan.last);
      scanner_.move_to(scan.first);
      while (!scanner_.at_line_end()) {
        scanner_.token();
        ++scan.values;
      }
      if (scan.cells > 0 && scan.values != 3 && scan.values != 4 && scan.values != 7)
        scanner_.fail(
            fmt::format("a line of {} values; it should hold x y z, an intensity, red green blue", scan.values),
            scan.first);
      scanner_.move_to(scan.last);
      scans_.push_back(scan);
    }
    if (scans_.empty()) scanner_.fail("no scan");
  }

  void read_header(Scan& scan) {
    const std::uint64_t columns = count("the number of columns"), rows = count("the number of rows");
    if (columns > 0 && rows > most_cells / columns)
      scanner_.fail(fmt::format("{} times {} cells are too many", columns, rows));
    scan.cells = columns * rows;
    const auto line = [this](const char* what, int values, double* to) {
      for (int k = 0; k < values; ++k) to[k] = scanner_.coordinate(what);
      end_line();
    };
    double unused[3];
    line("the scanner's place", 3, unused);
    for (int axis = 0; axis < 3; ++axis) line("the scanner's axis", 3, unused);
    double m[4][4];
    const char* matrix = scanner_.position();
    for (auto& row : m) line("the matrix", 4, row);
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1)
      scanner_.fail("the last column of the matrix is not 0 0 0 1", matrix);
    for (std::size_t k = 0; k < 3; ++k) scan.rotation[k] = Vec3(m[0][k], m[1][k], m[2][k]);
    scan.translation = Vec3(m[3][0], m[3][1], m[3][2]);
    double skew = 0;  // how far the matrix is from turning without stretching
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        skew = std::max(skew, std::abs((scan.rotation[a] | scan.rotation[b]) - (a == b ? 1 : 0)));
    if (skew > 1e-3)
      info_.notes.push_back(fmt::format("scan {}: its matrix stretches or shears by {:.3g}; it was applied as it is",
                                        scans_.size() + 1, skew));
  }

  static bool is_identity(const Scan& scan) {
    return scan.rotation == std::array<Vec3, 3>{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)} &&
           scan.translation == Vec3(0, 0, 0);
  }

  std::vector<PtxChunk> chunks_of(const Scan& scan) const {
    std::vector<PtxChunk> chunks;
    for (const char* p = scan.first; p < scan.last;) {
      const char* next = scan.last;
      if (static_cast<std::size_t>(scan.last - p) > ptx_chunk_size) {
        std::uint64_t line = 1;
        next = std::min(skip_lines(p + ptx_chunk_size, line), scan.last);
      }
      chunks.push_back({p, next, {}, 0, nullptr});
      p = next;
    }
    return chunks;
  }

  void read_scan(std::size_t index, std::uint64_t total, Context& context) {
    const Scan& scan = scans_[index];
    const bool posed = !is_identity(scan);
    const std::size_t before = set_.size();
    std::uint64_t skipped = 0;
    std::vector<PtxChunk> chunks = chunks_of(scan);
    const int cores = tbb::info::default_concurrency();
    tbb::task_arena arena(context.threads > 0 ? std::min(context.threads, cores) : cores);
    for (std::size_t begin = 0; begin < chunks.size(); begin += ptx_chunks_at_once) {
      context.checkpoint();
      context.progress("read",
                       static_cast<double>(chunks[begin].first - bytes_.data()) / static_cast<double>(bytes_.size()));
      const std::size_t end = std::min(chunks.size(), begin + ptx_chunks_at_once);
      arena.execute([&] { tbb::parallel_for(begin, end, [&](std::size_t i) { parse(chunks[i], scan, posed); }); });
      for (std::size_t i = begin; i < end; ++i) {
        if (chunks[i].error) std::rethrow_exception(chunks[i].error);
        skipped += chunks[i].skipped;
        if (set_.empty()) reserve(chunks[i].set, total);
        append(set_, chunks[i].set);
        chunks[i].set = {};
      }
    }
    // A stray carriage return ends a line for one and not for the other.
    if (set_.size() - before + skipped != scan.cells)
      scanner_.fail(fmt::format("{} lines for {} cells", set_.size() - before + skipped, scan.cells), scan.first);
    if (scans_.size() > 1 && set_.size() > before) {
      std::vector<double>& column = set_.scalars["scan"];
      if (before == 0) column.reserve(total);
      column.resize(before);
      column.resize(set_.size(), static_cast<double>(index + 1));
    }
    info_.points_skipped += skipped;
    info_.scans.push_back({"", "", set_.size() - before, skipped, posed, scan.rotation, scan.translation});
  }

  void reserve(const PointSet& like, std::uint64_t total) {
    if (!like.intensity.empty()) set_.intensity.reserve(total);
    if (!like.colors.empty()) set_.colors.reserve(total);
  }

  void parse(PtxChunk& chunk, const Scan& scan, bool posed) const {
    // Over all that comes before, so that lines are numbered as in the file.
    TextScanner scanner(bytes_.substr(0, static_cast<std::size_t>(chunk.last - bytes_.data())), file_);
    scanner.move_to(chunk.first);
    try {
      while (scanner.remaining() > 0) {
        const char* const line = scanner.position();
        const double x = scanner.coordinate("x"), y = scanner.coordinate("y"), z = scanner.coordinate("z");
        const double intensity = scan.values > 3 ? scanner.coordinate("the intensity") : 0;
        std::array<std::uint8_t, 3> color{0, 0, 0};
        if (scan.values == 7)
          for (std::uint8_t& c : color) c = level(scanner);
        if (!scanner.at_line_end()) scanner.fail(fmt::format("more than {} values", scan.values), line);
        scanner.next_line();
        if (x == 0 && y == 0 && z == 0) {
          ++chunk.skipped;
          continue;
        }
        const Vec3 own(x, y, z);
        chunk.set.points.push_back(
            posed ? Vec3(scan.rotation[0] | own, scan.rotation[1] | own, scan.rotation[2] | own) + scan.translation
                  : own);
        if (scan.values > 3) chunk.set.intensity.push_back(intensity);
        if (scan.values == 7) chunk.set.colors.push_back(color);
      }
    } catch (const IoError&) {
      chunk.error = std::current_exception();  // told if no earlier chunk has one
    }
  }

  static std::uint8_t level(TextScanner& scanner) {
    const char* first = scanner.position();
    const std::int64_t value = scanner.integer("a colour");
    if (value < 0 || value > 255) scanner.fail(fmt::format("a colour of {} is not within 0 to 255", value), first);
    return static_cast<std::uint8_t>(value);
  }

  std::string_view bytes_;
  const std::string& file_;
  PointsFileInfo& info_;
  TextScanner scanner_;
  char line_end_ = '\n';
  std::vector<Scan> scans_;
  PointSet set_;
};

}  // namespace

bool has_ptx_header(std::string_view bytes) {
  const std::string file;
  TextScanner scanner(bytes.substr(0, 4096), file);
  for (const int wanted : {1, 1, 3, 3, 3, 3, 4, 4, 4, 4}) {
    int found = 0;
    for (; !scanner.at_line_end(); ++found) {
      double value = 0;
      if (!parse_number(scanner.token(), value) || (wanted == 1 && (value < 0 || value != std::floor(value))))
        return false;
    }
    if (found != wanted) return false;
    scanner.next_line();
  }
  return true;
}

PointSet parse_ptx(std::string_view bytes, const std::string& file, Context& context, PointsFileInfo& info) {
  info.format = PointsFormat::ptx;
  return PtxParser(bytes, file, info).run(context);
}

}  // namespace tri::io_detail
