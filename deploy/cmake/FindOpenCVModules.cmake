# Debian's OpenCVConfig.cmake comes only with all of OpenCV (250 packages). This finds the single
# modules asked for as COMPONENTS and gives each the target OpenCV::NAME.

include(FindPackageHandleStandardArgs)

find_path(OpenCVModules_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
foreach(module IN LISTS OpenCVModules_FIND_COMPONENTS)
  find_library(OpenCVModules_${module}_LIBRARY opencv_${module})
  if(OpenCVModules_${module}_LIBRARY)
    set(OpenCVModules_${module}_FOUND TRUE)
    if(NOT TARGET OpenCV::${module})
      add_library(OpenCV::${module} UNKNOWN IMPORTED)
      set_target_properties(
        OpenCV::${module}
        PROPERTIES IMPORTED_LOCATION ${OpenCVModules_${module}_LIBRARY}
                   INTERFACE_INCLUDE_DIRECTORIES ${OpenCVModules_INCLUDE_DIR})
    endif()
  endif()
endforeach()

find_package_handle_standard_args(
  OpenCVModules
  REQUIRED_VARS OpenCVModules_INCLUDE_DIR
  HANDLE_COMPONENTS)
