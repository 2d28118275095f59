# The Python package `lamella`: wrapped classes beside the pure-Python layer of tools/python/lamella.
# In the build tree it stands in build/python/lamella (PYTHONPATH=build/python).
set(LAMELLA_PYTHON_DESTINATION "lib/python3/dist-packages" CACHE STRING
  "Where the Python package is installed, below the prefix; Debian's python3 looks there when the prefix is /usr")

function(lamella_python_package)
  # ParaView has found its own Python 3 (/usr/bin/python3) by now. Ours asks for headers too, of the same one.
  find_package(Python3 REQUIRED COMPONENTS Interpreter Development)

  vtk_module_wrap_python(
    MODULES ${LAMELLA_VTK_MODULES}
    TARGET Lamella::PythonWrapping
    PYTHON_PACKAGE "lamella"
    MODULE_DESTINATION "${LAMELLA_PYTHON_DESTINATION}"
    LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    CMAKE_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/lamella"
    WRAPPED_MODULES _wrapped
    BUILD_STATIC OFF
    INSTALL_HEADERS OFF)

  set(_folder "${CMAKE_BINARY_DIR}/python/lamella")
  foreach(module IN LISTS _wrapped)
    _vtk_module_get_module_property("${module}" PROPERTY "library_name" VARIABLE _library)
    set_target_properties("${_library}Python" PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${_folder}")
    add_dependencies(product "${_library}Python")
  endforeach()

  set(_source "${CMAKE_CURRENT_SOURCE_DIR}/tools/python/lamella")
  file(GLOB _files CONFIGURE_DEPENDS RELATIVE "${_source}" "${_source}/*.py" "${_source}/py.typed")
  set(_copies)
  foreach(file IN LISTS _files)
    add_custom_command(OUTPUT "${_folder}/${file}"
      COMMAND "${CMAKE_COMMAND}" -E copy_if_different "${_source}/${file}" "${_folder}/${file}"
      DEPENDS "${_source}/${file}" VERBATIM)
    list(APPEND _copies "${_folder}/${file}")
  endforeach()
  if(LAMELLA_PARAVIEW)
    set(_vtk "ParaView ${ParaView_VERSION}")
  else()
    set(_vtk "VTK ${VTK_VERSION}")
  endif()
  file(CONFIGURE OUTPUT "${_folder}/_version.py" CONTENT [=[
"""What this package was built as."""

__version__ = "@PROJECT_VERSION@"
PYTHON = "@Python3_VERSION_MAJOR@.@Python3_VERSION_MINOR@"
VTK = "@_vtk@"
]=] @ONLY)
  lamella_keywords("${_folder}/_declared.py")
  add_custom_target(LamellaPythonPackage ALL DEPENDS ${_copies} "${_folder}/_declared.py")
  add_dependencies(product LamellaPythonPackage)
  list(TRANSFORM _files PREPEND "${_source}/")
  install(FILES ${_files} "${_folder}/_declared.py" "${_folder}/_version.py" DESTINATION "${LAMELLA_PYTHON_DESTINATION}/lamella" COMPONENT python)
endfunction()
