# `cmake --install`, and the package that lets another project say
#
#   find_package(Lamella 0.1 REQUIRED)                       # or COMPONENTS Solvers, which needs no ParaView
#   target_link_libraries(mine Lamella::Solvers Lamella::Filters)
include(CMakePackageConfigHelpers)
set(_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/lamella")

install(TARGETS LamellaSolvers EXPORT LamellaSolvers
  LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" NAMELINK_COMPONENT Development
  FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/lamella" COMPONENT Development)
install(EXPORT LamellaSolvers NAMESPACE Lamella:: DESTINATION "${_package_dir}" COMPONENT Development)
# The build tree's targets file of the VTK modules (vtk_module_build writes it) refers to this one.
export(EXPORT LamellaSolvers NAMESPACE Lamella:: FILE "${PROJECT_BINARY_DIR}/${_package_dir}/LamellaSolvers.cmake")
install(FILES "${LAMELLA_GENERATED_INCLUDE_DIR}/lamella/Version.h"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/lamella" COMPONENT Development)

configure_package_config_file("${CMAKE_CURRENT_LIST_DIR}/LamellaConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/LamellaConfig.cmake" INSTALL_DESTINATION "${_package_dir}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/LamellaConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_LIST_DIR}/LamellaParaView.cmake" "${PROJECT_BINARY_DIR}/LamellaConfig.cmake" "${PROJECT_BINARY_DIR}/LamellaConfigVersion.cmake"
  DESTINATION "${_package_dir}" COMPONENT Development)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/CITATION.cff" "${PROJECT_SOURCE_DIR}/README.md"
  DESTINATION "${CMAKE_INSTALL_DOCDIR}")
