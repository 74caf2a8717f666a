# lumifield_embed_kernels(TARGET kernel.cl ... VARIANTS "-DX=1 -DY=2" ...): syntax-checks each OpenCL C 1.2 file with clang
# as every variant that the host compiles, and compiles its text into TARGET, to be had by name through renderer/opencl/kernel_source.h. #include "x" lines (structs shared with the host in
# *_shared.h, parts of kernels in *.clh) are resolved from the root.
find_program(LUMIFIELD_CLANG NAMES clang clang-14 REQUIRED)

function(lumifield_embed_kernels target)
  cmake_parse_arguments(EMBED "" "" "VARIANTS" ${ARGN})
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/embedded_kernels.cpp)
  file(GLOB_RECURSE included CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*_shared.h ${CMAKE_CURRENT_SOURCE_DIR}/*.clh)
  set(stamps)
  set(paths)
  foreach(kernel ${EMBED_UNPARSED_ARGUMENTS})
    set(path ${CMAKE_CURRENT_SOURCE_DIR}/${kernel})
    string(REPLACE "/" "_" stem ${kernel})
    set(stamp ${CMAKE_CURRENT_BINARY_DIR}/${stem}.checked)
    set(checks)
    foreach(variant ${EMBED_VARIANTS})
      separate_arguments(defines UNIX_COMMAND "${variant}")
      list(APPEND checks COMMAND ${LUMIFIELD_CLANG} -x cl -cl-std=CL1.2 -fsyntax-only -Wall -Werror
           -Xclang -finclude-default-header ${defines} -I ${PROJECT_SOURCE_DIR} ${path})
    endforeach()
    add_custom_command(OUTPUT ${stamp}
      ${checks}
      COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
      DEPENDS ${path} ${included} COMMENT "Checking ${kernel}" VERBATIM)
    list(APPEND stamps ${stamp})
    file(RELATIVE_PATH relative ${PROJECT_SOURCE_DIR} ${path})
    list(APPEND paths ${relative})
  endforeach()
  list(JOIN paths "|" kernels)
  add_custom_command(OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DKERNELS=${kernels} -DOUT=${generated}
            -P ${PROJECT_SOURCE_DIR}/cmake/embed_kernels.cmake
    DEPENDS ${EMBED_UNPARSED_ARGUMENTS} ${stamps} ${included} ${PROJECT_SOURCE_DIR}/cmake/embed_kernels.cmake
    COMMENT "Embedding kernels" VERBATIM)
  target_sources(${target} PRIVATE ${generated})
endfunction()
