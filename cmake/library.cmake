# tri_library(NAME OUTPUT_NAME): what the three libraries have in common: alias, version of the shared object, what it shows,
# and how it is installed. Its public headers are those of its file set HEADERS; all others stay in the source tree.

set(tri_exports ${CMAKE_CURRENT_LIST_DIR}/exports.map)

function(tri_library name output_name)
  add_library(tri::${name} ALIAS ${name})
  # Static libraries too may become part of a shared object: a plug-in, a Python module. Both kinds are compiled alike: no
  # macro for one of them, and functions that are not replaced by others of the same name, so that they may be inlined.
  target_compile_options(${name} PRIVATE -fno-semantic-interposition)
  set_target_properties(${name} PROPERTIES
    OUTPUT_NAME ${output_name}
    POSITION_INDEPENDENT_CODE ON
    DEFINE_SYMBOL ""
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_link_libraries(${name} PUBLIC $<BUILD_INTERFACE:tri_settings>)
  target_include_directories(${name} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  # A shared library shows namespace tri and nothing of what it was made with.
  get_target_property(type ${name} TYPE)
  if(type STREQUAL "SHARED_LIBRARY" AND UNIX AND NOT APPLE)
    target_link_options(${name} PRIVATE -Wl,--version-script=${tri_exports} -Wl,-z,defs)
    set_target_properties(${name} PROPERTIES LINK_DEPENDS ${tri_exports})
  endif()
  install(TARGETS ${name} EXPORT tri-${name}
    RUNTIME COMPONENT Runtime
    LIBRARY COMPONENT Runtime NAMELINK_COMPONENT Development
    ARCHIVE COMPONENT Development
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/tri COMPONENT Development)
  install(EXPORT tri-${name} NAMESPACE tri:: FILE tri-${name}-targets.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/tri COMPONENT Development)
endfunction()
