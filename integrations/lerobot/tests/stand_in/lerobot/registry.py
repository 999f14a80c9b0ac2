# SPDX-License-Identifier: Apache-2.0
"""Configurations that are chosen by a word, as draccus has them."""


class ChoiceRegistry:
    choices: dict = {}

    @classmethod
    def register_subclass(cls, name):
        def add(subclass):
            cls.choices = {**cls.choices, name: subclass}
            return subclass

        return add
