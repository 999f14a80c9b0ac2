# SPDX-License-Identifier: Apache-2.0
# The target `wheel`: the Python package with libtactus.so in it, for every Python 3 of this platform. It needs no network.

set(wheel_source ${PROJECT_BINARY_DIR}/wheel/source)
set(wheel_library ${PROJECT_BINARY_DIR}/wheel/libtactus.so.0)
file(GLOB wheel_modules CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/python/tactus/*.py)
list(APPEND wheel_modules ${PROJECT_SOURCE_DIR}/python/tactus/py.typed)

add_custom_target(wheel
  # What was there before would stay in the wheel.
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${wheel_source}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${wheel_source}/tactus
  COMMAND ${CMAKE_COMMAND} -E copy ${PROJECT_SOURCE_DIR}/python/pyproject.toml ${PROJECT_SOURCE_DIR}/python/setup.py
          ${PROJECT_SOURCE_DIR}/python/README.md ${PROJECT_SOURCE_DIR}/LICENSE ${wheel_source}
  COMMAND ${CMAKE_COMMAND} -E copy ${wheel_modules} ${wheel_source}/tactus
  COMMAND ${CMAKE_STRIP} --strip-unneeded -o ${wheel_library} $<TARGET_FILE:tactus_c_api>
  COMMAND ${CMAKE_COMMAND} -E env TACTUS_LIBRARY=${wheel_library} /usr/bin/python3 -m pip --quiet
          --disable-pip-version-check wheel --no-index --no-build-isolation --no-deps
          --wheel-dir ${PROJECT_BINARY_DIR}/wheel ${wheel_source}
  COMMENT "Making the wheel in ${PROJECT_BINARY_DIR}/wheel (needs python3-pip, python3-setuptools, python3-wheel)"
  VERBATIM)
add_dependencies(wheel tactus_c_api)
