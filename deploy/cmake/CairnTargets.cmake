# How every Cairn target is built: the language level, the warnings, the sanitizers.

include(GNUInstallDirs)

add_library(cairn_options INTERFACE)
target_compile_options(
  cairn_options
  INTERFACE -Wall
            -Wextra
            -Wpedantic
            -Wshadow
            -Wconversion
            -Wnon-virtual-dtor
            -Wold-style-cast
            # Merging evidence must give the same bits on every machine and optimisation level.
            -ffp-contract=off)
if(CAIRN_WERROR)
  target_compile_options(cairn_options INTERFACE -Werror)
endif()
if(CAIRN_SANITIZE)
  target_compile_options(cairn_options INTERFACE -fsanitize=${CAIRN_SANITIZE}
                                                 -fno-omit-frame-pointer)
  target_link_options(cairn_options INTERFACE -fsanitize=${CAIRN_SANITIZE})
endif()

# cairn_library(NAME SOURCES a.cc ... [LINKS public libs] [PRIVATE_LINKS libs])
# A static library cairn_NAME with the alias cairn::NAME; headers are found from the top folder.
function(cairn_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS;PRIVATE_LINKS" ${ARGN})
  add_library(cairn_${name} STATIC ${arg_SOURCES})
  add_library(cairn::${name} ALIAS cairn_${name})
  target_include_directories(cairn_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(
    cairn_${name}
    PUBLIC ${arg_LINKS}
    PRIVATE cairn_options ${arg_PRIVATE_LINKS})
endfunction()

# The same for a library of headers only.
function(cairn_headers name)
  cmake_parse_arguments(arg "" "" "LINKS" ${ARGN})
  add_library(cairn_${name} INTERFACE)
  add_library(cairn::${name} ALIAS cairn_${name})
  target_include_directories(cairn_${name} INTERFACE ${PROJECT_SOURCE_DIR})
  target_link_libraries(cairn_${name} INTERFACE ${arg_LINKS})
endfunction()

# cairn_program(NAME SOURCES ... LINKS ...): an installed executable.
function(cairn_program name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE cairn_options ${arg_LINKS})
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endfunction()
