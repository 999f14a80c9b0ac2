# SPDX-License-Identifier: Apache-2.0
"""Puts libtactus.so into the package, and names the wheel after the platform and no version of Python.

The library is the file that TACTUS_LIBRARY names, or that of ../build/release.
"""

import ctypes
import os
import pathlib
import shutil

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution

try:
    from wheel.bdist_wheel import bdist_wheel
except ImportError:  # needed for a wheel alone
    bdist_wheel = None

here = pathlib.Path(__file__).resolve().parent


def library():
    named = os.environ.get("TACTUS_LIBRARY")
    file = pathlib.Path(named) if named else here.parent / "build" / "release" / "lib" / "libtactus.so.0"
    if not file.exists():
        raise SystemExit(
            f"{file} is missing: build it with `cmake --build build/release --target tactus_c_api`, "
            "or let TACTUS_LIBRARY name the file"
        )
    return file.resolve()


def version():
    loaded = ctypes.CDLL(str(library()))
    loaded.tactus_version.restype = ctypes.c_char_p
    return loaded.tactus_version().decode()


class WithLibrary(build_py):
    def run(self):
        super().run()
        folder = pathlib.Path(self.build_lib) / "tactus" / "lib"
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copy2(library(), folder / "libtactus.so.0")


class OfAPlatform(Distribution):
    def has_ext_modules(self):
        return True


commands = {"build_py": WithLibrary}
if bdist_wheel is not None:

    class PlatformWheel(bdist_wheel):
        def get_tag(self):
            return ("py3", "none", super().get_tag()[2])

    commands["bdist_wheel"] = PlatformWheel

setup(version=version(), cmdclass=commands, distclass=OfAPlatform)
