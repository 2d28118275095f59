# Packages, made by ./dev package (preset package): of the distribution that they are built on, since a plugin fits one
# ParaView and a Python module one Python. The prefix is /usr from the beginning: Debian's folders follow from it.
option(LAMELLA_PACKAGE "Install what makes a package of Debian: ParaView's list of plugins, copyright, examples" OFF)
if(NOT LAMELLA_PACKAGE)
  return()
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lamella)
set(CPACK_PACKAGE_VENDOR "Lamella contributors")
set(CPACK_PACKAGE_CONTACT "Lamella contributors <lamella@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGE_DESCRIPTION "Effective conductivity, stiffness, strength and crushing of cellular and granular materials
from images and micro-CT volumes: lattice Boltzmann, multigrid, peridynamics, material points.
The program lamella, the Python package lamella and a plugin of ParaView.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON) # what the libraries say they need; what they do not say:
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${CMAKE_LIBRARY_OUTPUT_DIRECTORY}")
math(EXPR _next "${Python3_VERSION_MINOR} + 1")
set(CPACK_DEBIAN_PACKAGE_DEPENDS
  "python3-numpy, python3 (>= 3.${Python3_VERSION_MINOR}~), python3 (<< 3.${_next}~)")
if(LAMELLA_PARAVIEW)
  string(PREPEND CPACK_DEBIAN_PACKAGE_DEPENDS "python3-paraview, ")
else()
  string(PREPEND CPACK_DEBIAN_PACKAGE_DEPENDS "python3-vtk9, ")
endif()
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libosmesa6 | libegl1, libgl1-mesa-dri, mpi-default-bin")
if(LAMELLA_PARAVIEW AND ParaView_VERSION VERSION_GREATER_EQUAL 5.12) # icons of its window, of Qt 6 there
  string(APPEND CPACK_DEBIAN_PACKAGE_RECOMMENDS ", qt6-svg-plugins")
elseif(LAMELLA_PARAVIEW)
  string(APPEND CPACK_DEBIAN_PACKAGE_RECOMMENDS ", libqt5svg5")
endif()

# ParaView's list of plugins.
set(_plugin "${CMAKE_INSTALL_LIBDIR}/lamella")
if(LAMELLA_BUILD_PLUGIN AND ParaView_VERSION VERSION_GREATER_EQUAL 5.12) # it lists what lies in this folder
  install(CODE "
    file(MAKE_DIRECTORY \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share/paraview/plugins\")
    file(CREATE_LINK ../../../${_plugin}/Lamella
      \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share/paraview/plugins/Lamella\" SYMBOLIC)")
elseif(LAMELLA_BUILD_PLUGIN) # what this file beside its programs names, and no other place
  file(WRITE "${PROJECT_BINARY_DIR}/paraview.conf"
    "../lib/${CMAKE_LIBRARY_ARCHITECTURE}/paraview-${ParaView_VERSION_MAJOR}.${ParaView_VERSION_MINOR}/plugins/paraview.plugins.xml\n"
    "../${_plugin}/lamella.plugins.xml\n")
  install(FILES "${PROJECT_BINARY_DIR}/paraview.conf" DESTINATION "${CMAKE_INSTALL_BINDIR}")
endif()

# Static halves of the plugin, which nobody links.
install(CODE "
  file(GLOB archives \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_LIBDIR}/libvtkLamella*CS.a\")
  file(REMOVE \${archives})")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" RENAME copyright DESTINATION share/doc/lamella)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples" "${PROJECT_SOURCE_DIR}/data" "${PROJECT_SOURCE_DIR}/docs"
  DESTINATION share/doc/lamella USE_SOURCE_PERMISSIONS
  FILES_MATCHING PATTERN "*.md" PATTERN "*.py" PATTERN "*.sh" PATTERN "*.toml" PATTERN "data/*")
include(CPack)
