# SPDX-License-Identifier: Apache-2.0
"""Keeps the underscores of the distribution's name.

LeRobot finds plug-ins by the name in the metadata of installed distributions, and imports that very name. setuptools writes
`lerobot-robot-tactus` there, which LeRobot does not find.
"""

from setuptools import setup
from setuptools.command.egg_info import egg_info


class NameAsWritten(egg_info):
    def finalize_options(self):
        super().finalize_options()
        self.egg_name = self.distribution.get_name()


setup(cmdclass={"egg_info": NameAsWritten})
