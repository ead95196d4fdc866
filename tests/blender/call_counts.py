# SPDX-License-Identifier: GPL-3.0-or-later
"""How often functions of the add-on are called."""


def count_calls(monkeypatch, **functions):
    """{name: calls from now on} of name=(module, function's name there)."""
    count = dict.fromkeys(functions, 0)

    def counted(name, function):
        def call(*arguments):
            count[name] += 1
            return function(*arguments)

        return call

    for name, (module, attribute) in functions.items():
        monkeypatch.setattr(module, attribute, counted(name, getattr(module, attribute)))
    return count
