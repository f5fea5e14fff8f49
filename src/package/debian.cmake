# cpack -G DEB: libstiction0, libstiction-dev, stiction, and two packages apart from it: stiction-video draws in libav and
# with x264 is under the GPL, stiction-view draws in SDL. Configure with -DCMAKE_INSTALL_PREFIX=/usr.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR stiction)
set(CPACK_PACKAGE_CONTACT "The stiction authors <stiction@localhost>" CACHE STRING "Maintainer in Debian packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(about "Contact with friction by statics, for hand-held objects")
set(what "A tracked hand holds a convex object by a soft spring and presses it against
surfaces with friction; every frame's pose and forces come from the balance of
forces, without time steps or masses.")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # each package has its own

# COMPONENT PACKAGE SECTION one-line description, last paragraph; dependencies follow below
function(debian_package component package section brief text)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${package} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${brief}\n${what}\n\n${text}" PARENT_SCOPE)
  foreach(file copyright changelog.Debian.gz)
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${file} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package}
      COMPONENT ${component})
  endforeach()
endfunction()

debian_package(library libstiction0 libs "${about} (library)" "This is the shared library.")
debian_package(development libstiction-dev libdevel "${about} (development)"
  "Header, static library, CMake package, pkg-config file and an example.")
debian_package(program stiction science "${about}"
  "The program: solves traces and live trackers; logs, pictures, plots.")
debian_package(video stiction-video video "${about} (video)"
  "The part of the program stiction that writes video, through libav.")
debian_package(view stiction-view science "${about} (live view)"
  "The part of the program stiction that shows a run in a window, through SDL.")
set(CPACK_COMPONENTS_ALL library development program)
if(TARGET stiction_video)
  list(APPEND CPACK_COMPONENTS_ALL video)
endif()
if(TARGET stiction_window)
  list(APPEND CPACK_COMPONENTS_ALL view)
endif()

set(own_version "(= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/shlibs "libstiction 0 libstiction0 (>= ${PROJECT_VERSION})\n")
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_BINARY_DIR}/shlibs ${CMAKE_CURRENT_BINARY_DIR}/triggers)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libstiction0 ${own_version}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libode-dev, libyaml-dev")
set(CPACK_DEBIAN_VIDEO_PACKAGE_DEPENDS "stiction ${own_version}")
set(CPACK_DEBIAN_VIEW_PACKAGE_DEPENDS "stiction ${own_version}")
# found when they are wanted: a renderer, and gnuplot for `stiction plot`
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libosmesa6 | libegl1, gnuplot-nox | gnuplot, stiction-video, stiction-view")

set(licences)
foreach(file LICENSE render/LICENSE.dejavu render/report/LICENSE.uplot)
  file(READ ${PROJECT_SOURCE_DIR}/${file} licence)
  string(APPEND licences "${licence}\n")
endforeach()
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/copyright "${licences}")
configure_file(changelog.in changelog.Debian @ONLY)
compress(changelog.Debian)

include(CPack)
