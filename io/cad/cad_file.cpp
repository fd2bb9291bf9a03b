#include "io/cad/cad_file.hpp"

#include <fmt/format.h>

#include <BRepBuilderAPI_NurbsConvert.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BinTools.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <STEPControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "io/atomic_file.hpp"
#include "io/cad/cad_transfer.hpp"
#include "io/cad/occt_session.hpp"
#include "libtri/model/shape_occt.hpp"
#include "meshops/error.hpp"

namespace tri {
namespace {

enum class Format { iges, step, brep, brep_binary };

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

std::string read_part(std::ifstream& in, std::uintmax_t offset, std::size_t size) {
  std::string part(size, '\0');
  in.clear();
  in.seekg(static_cast<std::streamoff>(offset));
  in.read(part.data(), static_cast<std::streamsize>(size));
  part.resize(static_cast<std::size_t>(in.gcount()));
  return part;
}

/// True if one of the first lines carries one of `letters` in column 73, as every line of an IGES file does.
bool has_iges_section(const std::string& text, const char* letters) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line))
    if (line.size() >= 73 && std::string(letters).find(line[72]) != std::string::npos &&
        line.find_first_not_of(" 0123456789\r", 73) == std::string::npos)
      return true;
  return false;
}

/// Tells the format and whether the end is there. @throws IoError if not.
Format tell_format(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw IoError(path, "no such file");
  if (fs::is_directory(status)) throw IoError(path, "is a folder, not a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw IoError(path, "cannot be opened");
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) throw IoError(path, "is not a regular file");
  if (size == 0) throw IoError(path, "is empty");

  const std::string head = read_part(in, 0, 4096);
  const std::size_t tail_size = static_cast<std::size_t>(std::min<std::uintmax_t>(size, 65536));
  const std::string tail = read_part(in, size - tail_size, tail_size);
  if (head.find("ISO-10303-21") != std::string::npos) {
    if (tail.find("END-ISO-10303-21") == std::string::npos)
      throw IoError(path, "is truncated: a STEP file ends with END-ISO-10303-21", IoError::Unit::byte, size);
    return Format::step;
  }
  if (head.find("CASCADE Topology V") != std::string::npos && head.find("Open CASCADE Topology V") != 0)
    return Format::brep;
  if (head.find("DBRep_DrawableShape") != std::string::npos) return Format::brep;
  if (head.find("Open CASCADE Topology V") != std::string::npos) return Format::brep_binary;
  if (has_iges_section(head, "SCB")) {
    if (!has_iges_section(tail, "T"))
      throw IoError(path, "is truncated: an IGES file ends with a terminate section (T in column 73)",
                    IoError::Unit::byte, size);
    return Format::iges;
  }
  const std::string extension = lower_extension(path);
  const char* expected = extension == ".igs" || extension == ".iges"   ? "IGES"
                         : extension == ".stp" || extension == ".step" ? "STEP"
                         : extension == ".brep"                        ? "BREP"
                                                                       : nullptr;
  throw IoError(path, expected ? fmt::format("holds no {} data, whatever its extension says", expected)
                               : std::string("is no IGES, STEP or BREP file"));
}

/// OpenCASCADE's BREP readers complain on std::cout itself.
class MutedOutput {
 public:
  MutedOutput() : saved_(std::cout.rdbuf(nullptr)) {}
  ~MutedOutput() { std::cout.rdbuf(saved_); }
  MutedOutput(const MutedOutput&) = delete;
  MutedOutput& operator=(const MutedOutput&) = delete;

 private:
  std::streambuf* saved_;
};

CadTransfer transfer_brep(const std::string& path, bool binary) {
  CadTransfer result;
  std::ifstream in(path, std::ios::binary);
  // OpenCASCADE does not look at the stream's state and can loop for ever on a malformed number.
  in.exceptions(std::ios::failbit | std::ios::badbit);
  const MutedOutput muted;
  try {
    if (binary) {
      BinTools::Read(result.shape, in);
    } else {
      BRep_Builder builder;
      BRepTools::Read(result.shape, in, builder);
    }
  } catch (const Standard_Failure&) {
    result.shape.Nullify();
  } catch (const std::ios_base::failure&) {
    in.exceptions(std::ios::goodbit);
    in.clear();
    const auto position = in.tellg();
    throw IoError(path, "BREP is malformed here or ends early", IoError::Unit::byte,
                  position < 0 ? 0 : static_cast<std::uint64_t>(position));
  }
  if (result.shape.IsNull()) throw IoError(path, "cannot be parsed as BREP (its content is malformed or ends early)");
  return result;
}

}  // namespace

CadFile read_cad(const std::string& path, Context& context) {
  context.checkpoint();
  const Format format = tell_format(path);
  context.progress("read CAD", 0);
  const OcctSession session;
  CadTransfer transfer;
  const std::string failure = run_guarded([&] {
    switch (format) {
      case Format::iges:
        transfer = transfer_iges(path, context);
        break;
      case Format::step:
        transfer = transfer_step(path, context);
        break;
      case Format::brep:
        transfer = transfer_brep(path, false);
        break;
      case Format::brep_binary:
        transfer = transfer_brep(path, true);
        break;
    }
  });
  if (!failure.empty()) throw IoError(path, "cannot be read: " + failure);

  CadFile file = std::move(transfer.file);
  file.format = format == Format::iges ? "IGES" : format == Format::step ? "STEP" : "BREP";
  if (!transfer.shape.IsNull()) {
    const auto count = [&](TopAbs_ShapeEnum kind) {
      TopTools_IndexedMapOfShape map;
      TopExp::MapShapes(transfer.shape, kind, map);
      return map.Extent();
    };
    file.faces = count(TopAbs_FACE);
    file.shells = count(TopAbs_SHELL);
    file.solids = count(TopAbs_SOLID);
  }
  if (file.faces == 0) {
    std::string why = "it holds no surface";
    if (!file.failed.empty())
      why = fmt::format("{} of its entities failed, first {}: {}", file.failed.size(), file.failed[0].entity,
                        file.failed[0].reason) +
            (file.warnings.empty() ? "" : "; " + file.warnings[0]);
    else if (!file.warnings.empty())
      why = file.warnings[0];
    throw CadError(fmt::format("{}: no face could be read: {}", path, why));
  }
  file.shape = make_shape(transfer.shape, std::move(transfer.face_names));
  context.progress("read CAD", 1);
  return file;
}

void write_cad(const std::string& path, const Shape& shape) {
  if (shape.empty() || occt(shape).IsNull()) throw InvalidInput("write_cad: the shape is empty");
  const std::string extension = lower_extension(path);
  const bool iges = extension == ".igs" || extension == ".iges";
  const bool step = extension == ".stp" || extension == ".step";
  if (!iges && !step && extension != ".brep")
    throw InvalidInput(fmt::format("write_cad: the extension of {} is none of .igs .iges .stp .step .brep", path));

  AtomicFile output(path);
  const OcctSession session;
  const std::string failure = run_guarded([&] {
    if (step) {
      STEPControl_Writer writer;
      if (writer.Transfer(occt(shape), STEPControl_AsIs) != IFSelect_RetDone)
        throw CadError(path + ": the shape cannot be expressed in STEP");
      if (writer.Write(output.temporary_path().c_str()) != IFSelect_RetDone) throw IoError(path, "cannot be written");
      return;
    }
    std::ofstream out(output.temporary_path(), std::ios::binary);
    if (!out) throw IoError(path, "cannot be written");
    if (iges) {
      IGESControl_Controller::Init();
      IGESControl_Writer writer("MM", 0);
      BRepBuilderAPI_NurbsConvert convert(occt(shape), Standard_True);
      if (!writer.AddShape(convert.Shape())) throw CadError(path + ": the shape cannot be expressed in IGES");
      writer.ComputeModel();
      if (!writer.Write(out)) throw IoError(path, "cannot be written");
    } else {
      BRepTools::Write(occt(shape), out, Standard_False, Standard_False, TopTools_FormatVersion_CURRENT);
    }
    if (!out.flush()) throw IoError(path, "cannot be written");
  });
  if (!failure.empty()) throw CadError(fmt::format("{}: OpenCASCADE cannot write the shape: {}", path, failure));
  output.commit();
}

}  // namespace tri
