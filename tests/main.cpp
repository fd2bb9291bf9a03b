#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

// Read by the leak sanitizer, where the build has one. OpenCASCADE's STEP and IGES readers keep what they parsed of a
// broken file; everything of ours is still watched.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libTKernel\nleak:libTKXSBase\nleak:libTKSTEP\nleak:libTKIGES\n";
}
extern "C" const char* __lsan_default_options();
extern "C" const char* __lsan_default_options() {
  return "print_suppressions=0";
}
