# What is installed, below one prefix that may be moved:
#
#   bin/         limber-NAME: launchers of a few lines over
#   lib/         liblimber.so, in which all programs and the lab for others (lab/lab_interface.h) are; liblimber_receiver.so, for Python
#   share/limber robots, scenarios, message files: common/shared_folder.h
#   lcmtypes/    component python: the messages in Python and the tables it shares with C++
#
# None of it is built by default: `ninja installed`. A build folder has the same share/limber, so that programs find it alike.
include(GNUInstallDirs)
set(LIMBER_SHARE ${CMAKE_INSTALL_DATADIR}/limber)
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share)
file(CREATE_LINK ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/share/limber SYMBOLIC)

set(INSTALLED ${CMAKE_BINARY_DIR}/installed)
add_library(liblimber SHARED EXCLUDE_FROM_ALL)
set_target_properties(liblimber PROPERTIES
  OUTPUT_NAME limber LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION_MAJOR} SOVERSION ${PROJECT_VERSION_MAJOR} LIBRARY_OUTPUT_DIRECTORY ${INSTALLED}/lib)
target_link_libraries(liblimber PRIVATE limber_flags)
target_link_options(liblimber PRIVATE LINKER:--gc-sections LINKER:-z,now)
foreach(part can protocols gate dynamics controller)  # all that is public, used by a program or not
  target_link_options(liblimber PRIVATE LINKER:--whole-archive,$<TARGET_FILE:limber_${part}>,--no-whole-archive)
  add_dependencies(liblimber limber_${part})
endforeach()
add_custom_target(installed)
add_dependencies(installed liblimber limber_receiver)

# The main functions of limber-NAME in liblimber.so, and a launcher.
function(limber_installed name)
  cmake_parse_arguments(arg "" "" "LINK" ${ARGN})
  add_library(limber_main_${name} OBJECT EXCLUDE_FROM_ALL ${arg_UNPARSED_ARGUMENTS})
  target_compile_definitions(limber_main_${name} PRIVATE LIMBER_IN_LIBRARY)
  target_link_libraries(limber_main_${name} PRIVATE limber_flags ${arg_LINK})
  target_precompile_headers(limber_main_${name} REUSE_FROM limber_headers)
  target_sources(liblimber PRIVATE $<TARGET_OBJECTS:limber_main_${name}>)
  target_link_libraries(liblimber PRIVATE ${arg_LINK})
  set(launcher ${CMAKE_BINARY_DIR}/generated/launchers/${name}.cc)
  file(CONFIGURE OUTPUT ${launcher} CONTENT
    "extern \"C\" int limber_${name}_main(int, char**);\nint main(int argc, char** argv) { return limber_${name}_main(argc, argv); }\n")
  add_executable(installed-${name} EXCLUDE_FROM_ALL ${launcher})
  target_link_libraries(installed-${name} PRIVATE liblimber)
  set_target_properties(installed-${name} PROPERTIES
    OUTPUT_NAME limber-${name} RUNTIME_OUTPUT_DIRECTORY ${INSTALLED}/bin INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  add_dependencies(installed installed-${name})
  install(TARGETS installed-${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT runtime)
endfunction()

# limberConfig.cmake, for where it is installed and for a build folder: UP leads from its folder to the prefix.
function(limber_config file UP INCLUDES LIBRARY)
  configure_file(${CMAKE_SOURCE_DIR}/cmake/limberConfig.cmake.in ${file} @ONLY)
endfunction()

function(limber_install_files)
  limber_config(${CMAKE_BINARY_DIR}/lib/cmake/limber/limberConfig.cmake ../../..
    "${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated ${LIMBER_LCM_INCLUDE}" "${INSTALLED}/lib/liblimber.so.${PROJECT_VERSION_MAJOR}")
  file(RELATIVE_PATH up /p/${CMAKE_INSTALL_LIBDIR}/cmake/limber /p)
  limber_config(${CMAKE_BINARY_DIR}/package/limberConfig.cmake ${up} "\${prefix}/include/limber"
    "\${prefix}/${CMAKE_INSTALL_LIBDIR}/liblimber.so.${PROJECT_VERSION_MAJOR}")
  include(CMakePackageConfigHelpers)
  write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/limberConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  file(RELATIVE_PATH UP_FROM_PC /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
  configure_file(cmake/limber.pc.in package/limber.pc @ONLY)
  install(FILES ${CMAKE_BINARY_DIR}/package/limberConfig.cmake ${CMAKE_BINARY_DIR}/package/limberConfigVersion.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/limber COMPONENT dev)
  install(FILES ${CMAKE_BINARY_DIR}/package/limber.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
  set(headers ${CMAKE_INSTALL_INCLUDEDIR}/limber)
  foreach(folder drivers/protocols drivers/gate dynamics controller/kinds controller/model controller/impedance controller/elastic)
    install(DIRECTORY ${folder}/ DESTINATION ${headers}/${folder} COMPONENT dev FILES_MATCHING PATTERN *.h)
  endforeach()
  foreach(file common/can_address.h common/config_error.h common/joints.h common/public.h common/types.h controller/laws/law.h controller/laws/law_plugin.h drivers/can/can_bus.h
      lab/lab_interface.h
      drivers/can/can_filter.h drivers/can/can_frame.h
      lcmtypes/gains_table.h robots/loader/emergency_stop_config.h robots/loader/hand_travel.h robots/loader/joint_chain.h robots/loader/robot.h
      robots/loader/tip_sensor_config.h robots/loader/protocols/tip_sensor_protocol.h)
    cmake_path(GET file PARENT_PATH folder)
    install(FILES ${file} DESTINATION ${headers}/${folder} COMPONENT dev)
  endforeach()
  install(DIRECTORY ${CMAKE_BINARY_DIR}/generated/limber DESTINATION ${headers} COMPONENT dev FILES_MATCHING PATTERN *.h*)
  install(FILES ${LIMBER_LCM_INCLUDE}/lcm/lcm_coretypes.h DESTINATION ${headers}/lcm COMPONENT dev)
  install(TARGETS liblimber LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT namelink)
  install(TARGETS limber_receiver LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime)
  install(DIRECTORY robots scenarios DESTINATION ${LIMBER_SHARE} COMPONENT runtime
    FILES_MATCHING REGEX "/[^/]*\\.(yaml|urdf|md|stl|dae|obj)$" PATTERN loader EXCLUDE)
  install(DIRECTORY lcmtypes DESTINATION ${LIMBER_SHARE} COMPONENT runtime FILES_MATCHING PATTERN *.lcm)
  if(SKBUILD)  # a wheel carries these libraries: their licences, and where their sources are
    foreach(library ccd fmt ode orocos-kdl spdlog yaml-cpp zstd)
      file(GLOB texts /usr/share/doc/lib${library}[0-9]*/copyright)
      foreach(text IN LISTS texts)
        install(FILES ${text} DESTINATION ${LIMBER_SHARE}/licences RENAME ${library}.txt COMPONENT runtime)
      endforeach()
    endforeach()
  endif()
  install(FILES ${LIMBER_PYTHON_MESSAGES} DESTINATION lcmtypes COMPONENT python)
endfunction()
