# lumifield_embed_kernels(TARGET kernel.cl ...): syntax-checks each OpenCL C 1.2 file with clang and compiles its text into
# TARGET, to be had by name through renderer/opencl/kernel_source.h. #include "x.h" lines are resolved from the root.
find_program(LUMIFIELD_CLANG NAMES clang clang-14 REQUIRED)

function(lumifield_embed_kernels target)
  set(generated ${CMAKE_CURRENT_BINARY_DIR}/embedded_kernels.cpp)
  set(stamps)
  foreach(kernel ${ARGN})
    set(path ${CMAKE_CURRENT_SOURCE_DIR}/${kernel})
    string(REPLACE "/" "_" stem ${kernel})
    set(stamp ${CMAKE_CURRENT_BINARY_DIR}/${stem}.checked)
    add_custom_command(OUTPUT ${stamp}
      COMMAND ${LUMIFIELD_CLANG} -x cl -cl-std=CL1.2 -fsyntax-only -Wall -Werror -Xclang -finclude-default-header
              -I ${PROJECT_SOURCE_DIR} ${path}
      COMMAND ${CMAKE_COMMAND} -E touch ${stamp}
      DEPENDS ${path} COMMENT "Checking ${kernel}" VERBATIM)
    list(APPEND stamps ${stamp})
  endforeach()
  list(JOIN ARGN "|" kernels)
  file(GLOB_RECURSE shared_headers CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*_shared.h)
  add_custom_command(OUTPUT ${generated}
    COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DFOLDER=${CMAKE_CURRENT_SOURCE_DIR} -DKERNELS=${kernels}
            -DOUT=${generated} -P ${PROJECT_SOURCE_DIR}/cmake/embed_kernels.cmake
    DEPENDS ${ARGN} ${stamps} ${shared_headers} ${PROJECT_SOURCE_DIR}/cmake/embed_kernels.cmake VERBATIM)
  target_sources(${target} PRIVATE ${generated})
endfunction()
