# tri_add_plugin(NAME SOURCE...): a shared object that tri finds at run time (meshops/plugin.hpp). It shows nothing but the
# function `tri_plugin`, so that several plug-ins, and the program, may each hold parts of the library.
function(tri_add_plugin name)
  add_library(${name} MODULE ${ARGN})
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX .so CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_link_libraries(${name} PRIVATE tri::meshops)
  if(UNIX AND NOT APPLE)
    target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
  endif()
endfunction()
