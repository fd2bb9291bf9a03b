# Writes a C++ source that holds text files:
#   cmake -D OUTPUT=… -D page=FILE -D style=FILE -D script=FILE -D three=FILE -P embed_text.cmake
# A file that was not found (three=…-NOTFOUND) gives an empty text.
set(source "#include \"io/html/html_resources.hpp\"\n\nnamespace tri::html {\n")
foreach(name page style script three)
  set(text "")
  if(NOT "${${name}}" MATCHES "-NOTFOUND$")
    file(READ "${${name}}" text)
  endif()
  string(FIND "${text}" ")embedded\"" clash)
  if(NOT clash EQUAL -1)
    message(FATAL_ERROR "${${name}} holds what ends a literal")
  endif()
  string(APPEND source "const std::string_view ${name} = R\"embedded(${text})embedded\";\n")
endforeach()
string(APPEND source "}  // namespace tri::html\n")
file(WRITE "${OUTPUT}" "${source}")
