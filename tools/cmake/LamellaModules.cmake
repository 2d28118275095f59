# The VTK modules, each a folder with a vtk.module file: solvers/vtk, filters, filters/rendering, tools/vtk. Then their Python
# wrapping (build/python/lamella) and the ParaView plugin (build/lib/lamella).
include(LamellaPython)
include(LamellaDeclarations)

# lamella_module(NAME Lamella::X CLASSES vtkA ... [HEADERS h.h ...] [SOURCES s.cxx ...] [LINK target ...]
#                [PUBLIC_LINK target ...] [FOLDERS folder ...] [SETTINGS])
# A VTK module with our warnings. CLASSES are wrapped for Python; HEADERS are installed but not wrapped; SOURCES are
# helpers; what LINK names only the implementation sees. FOLDERS: of this one, where headers lie. SETTINGS: the headers
# declare settings, which are checked. Generated code is compiled in other targets, so our warnings meet hand-written code
# only. The export header is named after LIBRARY_NAME: vtkLamellaXModule.h.
function(lamella_module)
  cmake_parse_arguments(PARSE_ARGV 0 arg "SETTINGS" "NAME" "CLASSES;HEADERS;SOURCES;LINK;PUBLIC_LINK;FOLDERS")
  if(arg_UNPARSED_ARGUMENTS OR NOT arg_NAME OR NOT arg_CLASSES)
    message(FATAL_ERROR "lamella_module: NAME and CLASSES are needed; not understood: '${arg_UNPARSED_ARGUMENTS}'")
  endif()
  vtk_module_add_module(${arg_NAME}
    CLASSES ${arg_CLASSES}
    NOWRAP_HEADERS ${arg_HEADERS}
    SOURCES ${arg_SOURCES})
  if(arg_LINK)
    vtk_module_link(${arg_NAME} PRIVATE ${arg_LINK})
  endif()
  if(arg_PUBLIC_LINK)
    vtk_module_link(${arg_NAME} PUBLIC ${arg_PUBLIC_LINK})
  endif()
  _vtk_module_real_target(target ${arg_NAME})
  foreach(folder IN LISTS arg_FOLDERS)
    target_include_directories(${target} PUBLIC "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/${folder}>")
  endforeach()
  lamella_warnings(${target})
  if(arg_SETTINGS)
    lamella_check_settings(${target} ${arg_CLASSES})
  endif()
  if(arg_NAME STREQUAL "Lamella::SolversVTK")
    lamella_sanitize(${target})
  endif()
  # vtkTypeMacro(...); ends in a second semicolon, which -Wpedantic refuses here and wherever our headers are included.
  target_compile_options(${target} PUBLIC $<BUILD_INTERFACE:$<$<COMPILE_LANGUAGE:CXX>:-Wno-pedantic>>)
endfunction()

set(_module_files)
foreach(folder solvers/vtk filters filters/rendering tools/vtk)
  if(EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${folder}/vtk.module")
    list(APPEND _module_files "${CMAKE_CURRENT_SOURCE_DIR}/${folder}/vtk.module")
  endif()
endforeach()
if(NOT _module_files)
  return()
endif()
vtk_module_scan(
  MODULE_FILES ${_module_files}
  PROVIDES_MODULES LAMELLA_VTK_MODULES
  HIDE_MODULES_FROM_CACHE ON
  WANT_BY_DEFAULT ON
  ENABLE_TESTS OFF)
vtk_module_build(
  MODULES ${LAMELLA_VTK_MODULES}
  PACKAGE LamellaVTK
  VERSION "${PROJECT_VERSION}"
  SOVERSION "${PROJECT_VERSION_MAJOR}"
  INSTALL_EXPORT LamellaVTK
  HEADERS_DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/lamella"
  CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/lamella"
  LICENSE_DESTINATION "${CMAKE_INSTALL_DATAROOTDIR}/licenses/lamella"
  HIERARCHY_DESTINATION "${CMAKE_INSTALL_LIBDIR}/vtk/hierarchy/lamella"
  TEST_DIRECTORY_NAME NONE
  ENABLE_WRAPPING ON)

if(LAMELLA_BUILD_PYTHON)
  lamella_python_package()
endif()

if(LAMELLA_BUILD_PLUGIN AND EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/pvplugin/paraview.plugin")
  paraview_plugin_scan(
    PLUGIN_FILES "${CMAKE_CURRENT_SOURCE_DIR}/pvplugin/paraview.plugin"
    PROVIDES_PLUGINS _lamella_plugins
    ENABLE_BY_DEFAULT ON
    HIDE_PLUGINS_FROM_CACHE ON)
  paraview_plugin_build(
    PLUGINS ${_lamella_plugins}
    RUNTIME_DESTINATION "${CMAKE_INSTALL_BINDIR}"
    LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    LIBRARY_SUBDIRECTORY lamella
    PLUGINS_FILE_NAME lamella.plugins.xml
    INSTALL_HEADERS OFF
    DISABLE_XML_DOCUMENTATION ON)
  add_dependencies(product ${_lamella_plugins})
endif()
