# What the headers of the VTK classes declare of their settings (tools/settings/headers.py) is told there alone: tables by
# which a class checks what was set, ParaView's panels and Python's keywords are made from them while building.
find_package(Python3 REQUIRED COMPONENTS Interpreter)
set(LAMELLA_DECLARATIONS "${CMAKE_CURRENT_SOURCE_DIR}/tools/settings/make.py")
file(GLOB LAMELLA_DECLARATION_SCRIPTS CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/tools/settings/*.py")

# lamella_check_settings(target class ...): the classes of a module check their settings.
function(lamella_check_settings target)
  list(TRANSFORM ARGN APPEND ".h")
  list(TRANSFORM ARGN PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/")
  get_property(_others GLOBAL PROPERTY LAMELLA_DECLARING_HEADERS)
  set(_made "${CMAKE_CURRENT_BINARY_DIR}/${target}Settings.cxx")
  add_custom_command(OUTPUT "${_made}"
    COMMAND "${Python3_EXECUTABLE}" -B "${LAMELLA_DECLARATIONS}" tables "${_made}" ${ARGN} -- ${_others}
    DEPENDS ${LAMELLA_DECLARATION_SCRIPTS} ${ARGN} ${_others} VERBATIM)
  target_sources(${target} PRIVATE "${_made}")
  set_property(GLOBAL APPEND PROPERTY LAMELLA_DECLARING_HEADERS ${ARGN})
endfunction()

# lamella_panels(variable name ...): the XML of ParaView's panels, of layouts in this folder.
function(lamella_panels variable)
  get_property(_headers GLOBAL PROPERTY LAMELLA_DECLARING_HEADERS)
  file(GLOB _layouts CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.xml")
  list(TRANSFORM ARGN APPEND ".xml" OUTPUT_VARIABLE _made)
  list(TRANSFORM _made PREPEND "${CMAKE_CURRENT_BINARY_DIR}/panels/")
  add_custom_command(OUTPUT ${_made}
    COMMAND "${CMAKE_COMMAND}" -E make_directory "${CMAKE_CURRENT_BINARY_DIR}/panels"
    COMMAND "${Python3_EXECUTABLE}" -B "${LAMELLA_DECLARATIONS}" panels
      "${CMAKE_CURRENT_SOURCE_DIR}" "${CMAKE_CURRENT_BINARY_DIR}/panels" ${_headers}
    DEPENDS ${LAMELLA_DECLARATION_SCRIPTS} ${_layouts} ${_headers} VERBATIM)
  set(${variable} ${_made} PARENT_SCOPE)
endfunction()

# lamella_keywords(file): what the functions of the Python package take.
function(lamella_keywords file)
  get_property(_headers GLOBAL PROPERTY LAMELLA_DECLARING_HEADERS)
  add_custom_command(OUTPUT "${file}"
    COMMAND "${Python3_EXECUTABLE}" -B "${LAMELLA_DECLARATIONS}" python "${file}" ${_headers}
    DEPENDS ${LAMELLA_DECLARATION_SCRIPTS} ${_headers} VERBATIM)
endfunction()
