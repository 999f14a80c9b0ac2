# SPDX-License-Identifier: Apache-2.0
# tactus_module(NAME [HEADERS_ONLY] [LIGHT | WORDS] [TYPES_MEMORY] [SOURCES file...] [LINK target...] [LINK_PRIVATE target...])
#
# Declares the library target tactus::NAME from the current folder, tactus/COMPONENT/FOLDER. Headers sit beside their
# sources and are included as <tactus/COMPONENT/FOLDER/thing.hpp>. LIGHT: what it computes, it leaves to other modules. WORDS: it computes nothing that anybody
# waits for. It is static, or shared with BUILD_SHARED_LIBS. TYPES_MEMORY: it gives a type to memory that came without one, so the sanitizer looks how that is aligned.

find_program(TACTUS_CCACHE ccache)
if(TACTUS_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Which headers a source has read, the compiler says itself; else ccache reads them all beforehand, once more. Paths relative
  # to the build folder let two build folders beside each other, or two clones, share what was compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_DEPEND=1 CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
                                  CCACHE_ABSSTDERR=1 ${TACTUS_CCACHE})
endif()

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)

# What every target of this project is compiled with, and no user of the library inherits.
# -ffp-contract=off keeps results equal bit for bit between builds with and without fused multiply-add.
add_library(tactus_options INTERFACE)
target_compile_options(tactus_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wnon-virtual-dtor -Wold-style-cast
  -Woverloaded-virtual -Wnull-dereference -Wdouble-promotion -Wformat=2 -Wimplicit-fallthrough
  -ffp-contract=off
  # Templates fill the compiler's memory faster than it wants to tidy up.
  $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1048576>
  $<$<BOOL:${TACTUS_WARNINGS_AS_ERRORS}>:-Werror>)
if(TACTUS_SANITIZE)
  target_compile_options(tactus_options INTERFACE -fsanitize=${TACTUS_SANITIZE} -fno-sanitize-recover=all
                                                  -fno-omit-frame-pointer)
  # Not asked for again at every access: null pointers, small objects and objects that are gone end in the address
  # sanitizer, and only who gives memory a type can give it a place that does not suit (tactus_module). With all of these
  # what computes took two and a half times as long.
  if(TACTUS_SANITIZE MATCHES address)
    target_compile_options(tactus_options INTERFACE -fno-sanitize=null,object-size,vptr,alignment)
    # Of a function that several modules instantiate, the linker keeps the first: one of tactus_words, say, which is not
    # optimised. Products of small matrices took three times as long by that, so they are always inlined.
    target_compile_definitions(tactus_options INTERFACE "EIGEN_STRONG_INLINE=inline __attribute__((always_inline))")
    # Tests start the command hundreds of times. With its place in memory fixed and without what nobody calls, a start takes
    # two thirds of the time.
    target_link_options(tactus_options INTERFACE
      $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-no-pie>
      $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:-Wl,--gc-sections>)
  endif()
  target_link_options(tactus_options INTERFACE -fsanitize=${TACTUS_SANITIZE})
endif()

set_property(GLOBAL PROPERTY TACTUS_MODULES "")

# A compiler that optimises less follows values less far: it takes some pointers for null and some numbers for unset that
# are not. The rest of the build, and clang, look for those.
add_library(tactus_follows_less INTERFACE)
target_compile_options(tactus_follows_less INTERFACE
  $<$<CONFIG:Release>:-Wno-null-dereference>
  $<$<AND:$<CONFIG:Release>,$<CXX_COMPILER_ID:GNU>>:-Wno-maybe-uninitialized>)

# Linked after tactus_options by what compiles in half the time and needs no more: modules that are LIGHT, and tests that
# compute.
add_library(tactus_light INTERFACE)
target_link_libraries(tactus_light INTERFACE tactus_follows_less)
target_compile_options(tactus_light INTERFACE $<$<CONFIG:Release>:-O1>)

# The tests that run with the thread sanitizer hardly compute in these, and optimising them took half of their build.
if(TACTUS_SANITIZE MATCHES thread)
  target_compile_options(tactus_light INTERFACE -O0)
endif()

# By modules that are WORDS; TACTUS_WORDS_OPTIONS for single sources. More than half of the build with the address sanitizer
# was spent on optimising what it had added to these; in what computes, templates that are not optimised take the tests
# twenty times as long.
set(TACTUS_WORDS_OPTIONS)
if(TACTUS_SANITIZE MATCHES address)
  set(TACTUS_WORDS_OPTIONS -O0)
endif()
add_library(tactus_words INTERFACE)
target_link_libraries(tactus_words INTERFACE tactus_light)
target_compile_options(tactus_words INTERFACE ${TACTUS_WORDS_OPTIONS})

# By tests that spend their time in the libraries or wait: what instantiates much for a few calls compiles in little more
# than half the time.
add_library(tactus_unoptimised INTERFACE)
target_link_libraries(tactus_unoptimised INTERFACE tactus_follows_less)
target_compile_options(tactus_unoptimised INTERFACE -O0)

# Linked after tactus_options by modules with TYPES_MEMORY.
add_library(tactus_typed INTERFACE)
if(TACTUS_SANITIZE MATCHES address)
  target_compile_options(tactus_typed INTERFACE -fsanitize=alignment)
endif()

# The headers are read once for several sources of a target. A type without linkage of one of them may be used in another
# then, which is no mistake.
function(tactus_compile_together target)
  if(TACTUS_UNITY_BATCH GREATER 1)
    get_target_property(sources ${target} SOURCES)
    list(LENGTH sources count)
    math(EXPR batches "(${count} + ${TACTUS_UNITY_BATCH} - 1) / ${TACTUS_UNITY_BATCH}")
    math(EXPR batch "(${count} + ${batches} - 1) / ${batches}")  # of equal size, for several cores
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${batch})
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

function(tactus_module name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "HEADERS_ONLY;LIGHT;WORDS;TYPES_MEMORY" "" "SOURCES;LINK;LINK_PRIVATE")
  set(target tactus_${name})
  set(kind PUBLIC)
  if(arg_HEADERS_ONLY)
    set(kind INTERFACE)
    add_library(${target} INTERFACE)
  else()
    add_library(${target} ${arg_SOURCES})
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:tactus_options> ${arg_LINK_PRIVATE})
    if(arg_LIGHT)
      target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:tactus_light>)
    elseif(arg_WORDS)
      target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:tactus_words>)
    endif()
    if(arg_TYPES_MEMORY)
      target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:tactus_typed>)
    endif()
    tactus_compile_together(${target})
    # For libtactus.so, plug-ins and BUILD_SHARED_LIBS. A function of a library that could be replaced by one of the same
    # name would not be inlined. A shared library exports all of its classes, for users derive from and instantiate them.
    # No version promises a binary interface of C++ (docs/versioning.md), so each has a SONAME of its own.
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON VERSION ${PROJECT_VERSION}
                                               SOVERSION ${PROJECT_VERSION} INSTALL_RPATH "$ORIGIN")
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
  endif()
  add_library(tactus::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(${target} ${kind} cxx_std_20)
  target_include_directories(${target} ${kind} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                               $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} ${kind} ${arg_LINK})
  set_property(GLOBAL APPEND PROPERTY TACTUS_MODULES ${name})
endfunction()
